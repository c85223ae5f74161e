"""The master: structure of a system, schedule, steppers in Python and C, recorder, session."""
