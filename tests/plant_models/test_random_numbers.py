"""Random numbers: their distribution, their independence, and the same ones in C."""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from plant_models.random_numbers import MAX_SEED, _logarithm, random_bits, random_normal, random_stream
from tests.helpers.paths import ROOT

COUNT = 100_000


@pytest.fixture(scope="module")
def numbers() -> np.ndarray:
    stream = random_stream(1)
    return np.array([random_normal(stream, index) for index in range(COUNT)])


def test_bits_are_those_of_splitmix64():
    """The first numbers of the published algorithm from state 0."""
    expected = [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F, 0xF88BB8A8724C81EC]
    assert [random_bits(0, index) for index in range(4)] == expected


def test_numbers_are_normal(numbers: np.ndarray):
    """Each figure within four standard errors of its own."""
    assert abs(numbers.mean()) < 4 / math.sqrt(COUNT)
    assert abs(numbers.std() - 1.0) < 4 / math.sqrt(2 * COUNT)
    assert abs(stats.skew(numbers)) < 4 * math.sqrt(6 / COUNT)
    assert abs(stats.kurtosis(numbers)) < 4 * math.sqrt(24 / COUNT)
    assert stats.kstest(numbers, "norm").pvalue > 1e-4
    for limit in (2.0, 3.0, 4.0):
        expected = COUNT * 2 * stats.norm.sf(limit)
        assert abs((np.abs(numbers) > limit).sum() - expected) < 4 * math.sqrt(expected)


@pytest.mark.slow
def test_streams_are_independent(numbers: np.ndarray):
    """Neither neighbours, nor streams of one seed, nor of neighbouring seeds."""
    others = [
        np.array([random_normal(random_stream(seed, number), i) for i in range(COUNT)])
        for seed, number in ((1, 1), (2, 0))
    ]
    pairs = [*((numbers[lag:], numbers[:-lag]) for lag in (1, 2, 3, 10)), *((numbers, other) for other in others)]
    for one, other in pairs:
        for power in (1, 2):
            assert abs(np.corrcoef(one**power, other**power)[0, 1]) < 4 / math.sqrt(len(one))


def test_the_logarithm_is_accurate():
    random = np.random.default_rng(5)
    for x in [
        *random.uniform(0.0, 1.0, 2000),
        *(1.0 - 2.0**-k for k in range(1, 53)),
        *(10.0**-k for k in range(1, 20)),
    ]:
        assert _logarithm(float(x)) == pytest.approx(math.log(x), rel=4e-16)


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int, int, int], float]:
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    built = tmp_path_factory.mktemp("random") / "random.so"
    source = ROOT / "plant_models/random_numbers.c"
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run(["gcc", *options, str(source), "-o", str(built), "-lm"], check=True)
    library = ctypes.CDLL(str(Path(built)))
    library.random_stream.restype = ctypes.c_uint64
    library.random_stream.argtypes = [ctypes.c_uint32, ctypes.c_uint32]
    library.random_normal.restype = ctypes.c_double
    library.random_normal.argtypes = [ctypes.c_uint64, ctypes.c_int64]
    return lambda seed, number, index: library.random_normal(library.random_stream(seed, number), index)


def test_c_gives_the_same_bits(in_c: Callable[[int, int, int], float]):
    for seed in (0, 1, 2, 12345, MAX_SEED):
        for number in (0, 1, 7):
            for index in (*range(-20, 500), 2**40, -(2**40)):
                assert in_c(seed, number, index) == random_normal(random_stream(seed, number), index)
