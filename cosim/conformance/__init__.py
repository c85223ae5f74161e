"""A conformance suite for co-simulation FMUs (FMI 2.0 and 3.0): rules, and what runs them on any FMU.

Rules stand one function each in a module for each subject; :mod:`cosim.conformance.rule` explains how they are written,
:func:`cosim.conformance.suite.validate` applies them.
"""

TIME_LIMIT = 10.0
"""How long a rule may run an FMU where nothing else is said, in s."""
