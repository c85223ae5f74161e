"""The result of a run: a table of values over time, in memory and in files."""
