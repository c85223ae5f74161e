"""Features of FMUs that this master does not support, each refused by name before an FMU is loaded."""

from __future__ import annotations

from collections import Counter

from fmpy.model_description import ModelDescription


def unsupported(description: ModelDescription) -> list[str]:
    """Find what an FMU needs and this master does not support.

    Parameters
    ----------
    description
        fmpy's reading of the ``modelDescription.xml``.

    Returns
    -------
    list of str
        A line for each variable and feature.
    """
    names = Counter(variable.name for variable in description.modelVariables)
    problems = [
        f"{name}: expected one variable of this name, got {count}" for name, count in names.items() if count > 1
    ]
    for variable in description.modelVariables:
        if variable.type == "Clock":
            kind = "triggered clock" if variable.intervalVariability == "triggered" else "clock"
            problems.append(f"{variable.name}: expected no clocks, got a {kind} (event mode is not supported)")
    return problems
