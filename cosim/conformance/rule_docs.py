"""The rules as a page of tables."""

from __future__ import annotations

from collections.abc import Iterator

from cosim.conformance import TIME_LIMIT
from cosim.conformance.rule import Rule
from cosim.conformance.suite import MODULES, load_rules

_HEAD = f"""# Checking FMUs

`seat-cosim validate FILE.fmu` applies these rules to any FMU for co-simulation, FMI 2.0 or 3.0, whoever made it:

    seat-cosim validate Foreign.fmu
    seat-cosim validate --strict --json report.json *.fmu
    seat-cosim validate --rule lifecycle.reset --full Foreign.fmu

Each rule gets a row: passed, FAILED, warning, or not applicable and why. What the standard demands is an error, what
is merely wise a warning. The exit code is 0 where there are no errors, 1 where there are (with `--strict` also for
warnings), 2 for wrong use and missing files. `--json FILE` writes the same for machines, `--json -` to standard output.

Rules of the groups binary, lifecycle, steps, state and side_effects run the FMU: each in a process of its own, with a
limit of {TIME_LIMIT:g} s (`--time-limit`), so that a crash or a hang is a finding of the rule that met it. They need
Linux or macOS and a library for this machine. It runs with the rights of whoever calls it: a process of its own is no
sandbox.

Runs have at most 20 steps of the default experiment's size. Real inputs move by a tenth around their start value. Where
a rule rests on another that failed, it is not applicable and names it. FMUs with clocks, which need event mode, are
checked as far as their files go.

The page is written by `python -m seat_cosim.reference`. Clauses are those of FMI 2.0 and 3.0.
"""

_NO_CLAUSE = {"error": "safety", "warning": "wise"}

_TITLES = {
    "archive": "The archive",
    "description": "The description",
    "variables": "Variables",
    "structure": "The model structure",
    "fmpy_check": "fmpy's own check",
    "binary": "The library",
    "lifecycle": "The life cycle of an instance",
    "steps": "Steps and values",
    "state": "The state",
    "side_effects": "Side effects",
}

_FOREIGN = """
## What it found

Seen with the FMUs at hand; each finding was looked up in the standard.

- **The native FMUs of this repository**: nothing. When the suite was first run, they did not refuse a step past the
  announced stop time, and the Python flavours of seat and shaker could not set a state outside this repository. Both
  are mended.
- **The Python flavours** (pythonfmu 0.7.0): `state.free` (the pointer is not null afterwards), `side_effects.memory` (5
  KiB for each instance); warnings of `lifecycle.token`, `lifecycle.call-order` and `lifecycle.fixed`. All are of
  pythonfmu's library, which answers these calls itself or has no way to refuse.
- **Raw pythonfmu** (`examples/foreign`, `examples/controllers`): as above, and `steps.stop-time`, `steps.backward`,
  `structure.initial-unknowns` (outputs are not listed); in the foreign ones also `variables.combinations` (parameters
  without a variability, which makes them continuous).
- **Raw pythonfmu3** (`examples/foreign`): `steps.stop-time`; in Chair `steps.time`, as its independent variable stays
  at 0. Warnings of `archive.sources` (the Python script lies in `sources`, without a buildDescription.xml),
  `lifecycle.token`, `lifecycle.call-order`, `steps.backward`.
- **Six FMI 2.0 FMUs of OpenModelica 1.19 to 1.21** (those that gemseo-fmu 3.1.1 carries): `lifecycle.free-null`
  (freeing a null pointer crashes), `side_effects.memory` (4 to 11 KiB for each instance); in one of them
  `lifecycle.start-values` (an output said to begin at exactly -0.5 begins at 0) and `variables.names-legal`
  (`der(der(s))`, where the convention has `der(s, 2)`). Warnings of `lifecycle.fixed`, `steps.backward`,
  `archive.stray`.
- **Four FMUs of crane-fmu 0.2.0** (pythonfmu, FMI 2.0): `lifecycle.instantiate`, as they need Python packages that
  were not there; a warning of `structure.dependencies-told`.
"""


def page() -> str:
    """Write the page."""
    rules = load_rules().values()
    parts = [_HEAD]
    for module in MODULES:
        chosen = [rule for rule in rules if rule.id.partition(".")[0] == module]
        parts.append("\n".join([f"\n## {_TITLES[module]}\n", *_table(chosen)]) + "\n")
    return "".join((*parts, _FOREIGN))


def _table(rules: list[Rule]) -> Iterator[str]:
    yield "| rule | what holds | severity | clause |"
    yield "| --- | --- | --- | --- |"
    for rule in rules:
        yield f"| `{rule.id}` | {rule.title} | {rule.severity} | {rule.clause or _NO_CLAUSE[rule.severity]} |"
