"""Export of a component as an FMU file: model description, C headers, documentation, binaries, archive."""
