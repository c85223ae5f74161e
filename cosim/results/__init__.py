"""What a run leaves: a table over time, in memory and in files."""
