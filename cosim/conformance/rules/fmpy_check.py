"""A second opinion on the description, where no rule of ours found anything."""

from __future__ import annotations

from collections.abc import Iterator

import fmpy
from fmpy.validation import validate_model_description

from cosim.conformance.fmu_archive import Subject
from cosim.conformance.rule import rule
from cosim.conformance.rules.description import described
from cosim.fmi.repairs import DESCRIPTION


@rule(
    "fmpy_check.fmpy",
    "fmpy's own validation finds nothing either",
    clause="2.0 §2.2; 3.0 §2.4",
    stage="description",
    last=True,
)
def second_opinion(fmu: Subject) -> Iterator[str]:
    described(fmu)
    try:
        found = fmpy.read_model_description(str(fmu.path), validate=False)
        yield from validate_model_description(found, validate_model_structure=True)
    except Exception as error:  # whatever fmpy stumbles over
        yield f"{DESCRIPTION}: expected a description that fmpy can read, got: {error}"
