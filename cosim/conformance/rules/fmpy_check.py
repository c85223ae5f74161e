"""The rule that applies fmpy's own validation where no other rule on the description found anything."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy

import fmpy
from fmpy.validation import validate_model_description

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import require_description
from cosim.fmi.repairs import DESCRIPTION, archive_of, normalize_lists

MAX_VARIABLES = 20_000
"""Up to how many variables fmpy's validation is applied."""


@rule(
    "fmpy_check.fmpy",
    "fmpy's own validation finds nothing either",
    clause="2.0 §2.2; 3.0 §2.4",
    stage="description",
    only_if_stage_passed=True,
)
def fmpy_validation(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if len(found.variables) > MAX_VARIABLES:
        raise NotApplicableError(f"at most {MAX_VARIABLES} variables, as fmpy needs too long and too much memory")
    tree = deepcopy(fmu.description_root)
    source = archive_of(tree) if normalize_lists(tree) else str(fmu.path)  # fmpy reads no other white space
    try:
        read = fmpy.read_model_description(source, validate=False)
        yield from validate_model_description(read, validate_model_structure=True)
    except Exception as error:  # fmpy raises exceptions of many types for invalid files
        yield f"{DESCRIPTION}: expected a description that fmpy can read, got: {error}"
