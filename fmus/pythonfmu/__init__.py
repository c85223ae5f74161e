"""The code of a Python FMU. Apart from ``fmus/python``, where built Python FMUs lie."""
