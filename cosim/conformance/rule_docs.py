"""Generate the documentation page of the rules."""

from __future__ import annotations

from collections.abc import Iterator

from cosim.conformance import TIME_LIMIT
from cosim.conformance.rule import Rule
from cosim.conformance.suite import MODULES, load_rules

_INTRODUCTION = f"""# Checking FMUs

`seat-cosim validate FILE.fmu` applies these rules to any FMU for co-simulation, FMI 2.0 or 3.0, from any tool:

    seat-cosim validate Foreign.fmu
    seat-cosim validate --strict --json report.json *.fmu
    seat-cosim validate --rule lifecycle.reset --full Foreign.fmu

Each rule gets a row: passed, FAILED, warning, or not applicable with the reason. A violation of the standard is an
error, a deviation from good practice a warning. The exit code is 0 without errors, 1 with errors (with `--strict` also
with warnings), 2 for wrong use and missing files. `--json FILE` writes the results for programs, `--json -` to standard
output.

Rules of the groups binary, lifecycle, steps, state and side_effects, and `arrays.access`, run the FMU, each in a
separate process with a time limit of {TIME_LIMIT:g} s, so that a crash or a hang is a finding of that rule. A slow FMU,
one whose first step waits for a licence for example, needs a longer limit (`--time-limit`). These rules need Linux or
macOS and a library for this machine. The FMU has the rights of the user: a separate process is not a sandbox.

A run has at most 20 steps of the default experiment's step size. Floating-point inputs vary by a tenth around their
start value. A rule that needs another one that failed is not applicable and names it. The behaviour of FMUs with
clocks, which need event mode, is not checked.

This page is written by `python -m seat_cosim.reference`. Clauses are those of FMI 2.0 and 3.0.
"""

_NO_CLAUSE = {"error": "safety", "warning": "good practice"}
"""Severity to what stands in the place of a clause."""

_TITLES = {
    "archive": "The archive",
    "description": "The description",
    "variables": "Variables",
    "arrays": "Arrays",
    "clocks": "Clocks",
    "structure": "The model structure",
    "fmpy_check": "fmpy's own check",
    "binary": "The library",
    "lifecycle": "The lifecycle of an instance",
    "steps": "Steps and values",
    "state": "The FMU state",
    "side_effects": "Side effects",
}
"""Group of rules to its heading."""

_RESULTS = """
## Results with FMUs of several tools

Each finding was checked against the standard.

- **The native FMUs of this repository**: none. In the first run of the suite, they accepted a step past the defined
  stop time, and the Python flavours of seat and shaker could not set a state outside this repository. Both are fixed.
- **The Python flavours** (pythonfmu 0.7.0): `state.free` (the pointer is not null afterwards), `side_effects.memory` (4
  to 6 KiB for each instance); warnings of `lifecycle.token`, `lifecycle.call-order` and `lifecycle.fixed`. The cause is
  pythonfmu's library, which handles these calls itself or cannot reject them.
- **Raw pythonfmu** (`examples/foreign`, `examples/controllers`): as above, and `steps.stop-time`, `steps.backward`,
  `structure.initial-unknowns` (outputs are not listed); in the foreign ones also `variables.combinations` (parameters
  without a variability, which makes them continuous). A warning of `description.date` (a time zone of `+00:00`, where
  the standard has `Z`).
- **Raw pythonfmu3** (`examples/foreign`): `steps.stop-time`; in Chair `steps.time`, as its independent variable stays
  at 0, and `side_effects.memory` (1 KiB for each instance). Warnings of `archive.sources` (the sources of pythonfmu3's
  library lie in `sources`, without a buildDescription.xml), `description.date`, `lifecycle.token`,
  `lifecycle.call-order`, `steps.backward`.
- **Six FMI 2.0 FMUs of OpenModelica 1.19 to 1.21** (those in gemseo-fmu 3.1.1): `lifecycle.free-null` (freeing a null
  pointer crashes), `side_effects.memory` (4 to 11 KiB for each instance); in one of them `lifecycle.start-values` (an
  output with an exact start value of -0.5 starts at 0) and `variables.names-legal` (`der(der(s))`, where the convention
  has `der(s, 2)`). Warnings of `lifecycle.fixed`, `steps.backward`, `archive.stray`.
- **Four FMUs of crane-fmu 0.2.0** (pythonfmu, FMI 2.0): `lifecycle.instantiate`, as they need Python packages that were
  not installed; a warning of `structure.dependencies-told`.
"""


def page() -> str:
    """Return the page as Markdown."""
    rules = load_rules().values()
    parts = [_INTRODUCTION]
    for module in MODULES:
        group = [rule for rule in rules if rule.id.partition(".")[0] == module]
        parts.append("\n".join([f"\n## {_TITLES[module]}\n", *_table(group)]) + "\n")
    return "".join((*parts, _RESULTS))


def _table(rules: list[Rule]) -> Iterator[str]:
    yield "| rule | what holds | severity | clause |"
    yield "| --- | --- | --- | --- |"
    for rule in rules:
        yield f"| `{rule.id}` | {rule.title} | {rule.severity} | {rule.clause or _NO_CLAUSE[rule.severity]} |"
