"""A conformance suite for co-simulation FMUs of FMI 2.0 and 3.0, from any tool.

The rules are functions in the modules of :mod:`cosim.conformance.rules`, one module for each group.
:mod:`cosim.conformance.rule` says how a rule is written, :func:`cosim.conformance.suite.validate` applies them.
"""

TIME_LIMIT = 10.0
"""Default limit for the time that a rule may run an FMU, in s."""
