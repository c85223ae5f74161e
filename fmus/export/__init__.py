"""How a component becomes an FMU file: description, C header, documentation, binaries, archive."""
