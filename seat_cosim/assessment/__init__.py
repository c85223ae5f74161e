"""Assessment of measured rides by ISO 2631-1, ISO 10326-1 and Directive 2002/44/EC, without any FMU."""

DATA = "assessment.json"
"""Name of the file with all numbers and the command line that made them."""
