"""The example notebooks run from their first cell to their last."""

import contextlib
import json

import matplotlib.pyplot as plt
import pytest

from tests.project import REPOSITORY, Project

NOTEBOOKS = REPOSITORY / "notebooks"


def cells(name):
    """Return the sources of a notebook's cells of code."""
    found = json.loads((NOTEBOOKS / name).read_text("utf-8"))
    return ["".join(cell["source"]) for cell in found["cells"] if cell["cell_type"] == "code"]


@pytest.fixture
def run():
    """Return a function that runs the cells of a notebook in order and returns their names."""

    def run(name):
        there = {}
        with plt.rc_context({"backend": "agg"}):
            for k, source in enumerate(cells(name)):
                exec(compile(source, f"{name}, cell {k}", "exec"), there)
        return there

    yield run
    plt.close("all")


def test_one_orbit(run):
    there = run("one_orbit.ipynb")
    assert there["orbit"].stable
    assert there["branch"].bifurcations[0].type == "symmetry_breaking"
    assert len(there["ax"].lines) == 2
    assert there["ax"].get_xlabel() == "forcing amplitude A"


def test_a_study(run, tmp_path):
    Project(tmp_path).vines("init", "mine")
    with contextlib.chdir(tmp_path / "mine"):
        there = run("a_study.ipynb")
    assert len(there["points"]) == 46
    assert there["figure"].axes[0].get_ylim() == (-2.5, 2.5)


@pytest.mark.parametrize("name", ["one_orbit.ipynb", "a_study.ipynb"])
def test_nothing_that_was_computed_is_kept_in_them(name):
    found = json.loads((NOTEBOOKS / name).read_text("utf-8"))
    assert all(cell.get("outputs", []) == [] and cell.get("execution_count") is None for cell in found["cells"])
