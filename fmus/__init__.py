"""How a component becomes an FMU: variables, description, flavours, build. Built FMUs lie in subfolders here."""
