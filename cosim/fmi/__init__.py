"""One FMU: description, archive, instance, values, messages; in this process or in one of its own."""
