"""What the tests of the conformance suite share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from cosim.conformance.process import RuleRunner
from tests.helpers.reference_fmus import ReferenceFmus


@pytest.fixture(scope="module")
def runner() -> Iterator[RuleRunner]:
    with RuleRunner() as shared:
        yield shared


@pytest.fixture(scope="module")
def reference_fmus(tmp_path_factory: pytest.TempPathFactory) -> ReferenceFmus:
    return ReferenceFmus(tmp_path_factory.mktemp("reference"))
