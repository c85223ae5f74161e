"""Code of the Python FMUs. Built Python FMUs are in ``fmus/python``."""
