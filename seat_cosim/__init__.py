"""The application: everything that knows what a seat suspension is."""
