"""The application of this project: the active seat suspension, its scenarios, evaluation and command line."""
