"""How a component becomes an FMU: variables, description, flavours, build. Built FMUs lie in subfolders here."""

FLAVOURS = ("fmi2", "fmi3", "python")
"""All flavours, the default first; the FMUs of a flavour lie in the folder of its name."""
