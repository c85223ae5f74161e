"""Export of components as FMUs: declaration of variables, model descriptions, C headers, builds.

Built FMUs are written to subfolders of this folder.
"""

FLAVOURS = ("fmi2", "fmi3", "python")
"""Names of all flavours, the default first; each flavour's FMUs are in the folder of its name."""
