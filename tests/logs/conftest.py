"""A small run, made up: the logs must carry any numbers that fit the schema."""

import numpy as np
import pytest

from vines.logs import write_run
from vines.schema import numpy_dtype


def made_up(name: str, count: int, time: str, seed: int) -> np.ndarray:
    """Return rows of random numbers, sorted by time."""
    random = np.random.default_rng(seed)
    dtype = numpy_dtype(name)
    rows = np.zeros(count, dtype)
    for field in dtype.names:
        rows[field] = random.standard_normal(count) if dtype[field].kind == "f" else random.integers(-1, 2, count)
    rows[time] = np.sort(random.uniform(0.0, 60.0, count))
    return rows


@pytest.fixture(scope="session")
def run():
    sticks = made_up("vines.v1.Stick", 3, "t_start", 3)
    sticks["t_release"][-1] = sticks["phase_release"][-1] = np.nan
    return {
        "states": made_up("vines.v1.State", 3000, "t", 1),
        "impacts": made_up("vines.v1.Impact", 40, "t", 2),
        "sticks": sticks,
        "provenance": {"stage": "quickstart.run", "key": "0f", "versions": {"numpy": "2", "numba": "0.6"}},
        "parameters": {"mu": 0.01, "A": 0.1 + 0.2, "Omega": 1.0, "r": 0.65, "lam": 0.011997967},
        "name": "made up",
        "declaration": "[params]\nmu = 0.01  # µ\n",
        "bare": False,
    }


@pytest.fixture
def log_file(run, tmp_path):
    return write_run(tmp_path / "run.mcap", **run)
