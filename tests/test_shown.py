"""How results show themselves: a line in a terminal, a small table in a notebook."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from vines.attractors import Attractor, settle
from vines.dynamics import Trajectory, simulate
from vines.model import Params
from vines.orbits import Branch, Orbit, find_orbit

P = Params(mu=0.01, A=0.02, Omega=1.0, r=0.65)


@pytest.fixture(scope="module")
def orbit() -> Orbit:
    return find_orbit("LR", P)


def facts(shown: str) -> dict[str, str]:
    """Return title and rows of a table; that it parses as XML says that every text in it is escaped and closed."""
    table = ET.fromstring(shown.replace("<br>", "<br/>"))
    assert table.tag == "table"
    rows = {row[0].text or "": "|".join(row[1].itertext()) for row in table.iter("tr")}
    return {"": table.findtext("caption") or "", **rows}


def test_an_orbit(orbit: Orbit) -> None:
    shown = facts(orbit._repr_html_())
    assert shown[""] == "1:1 (LR)"
    assert (shown["symmetric"], shown["stable"]) == ("yes", "yes" if orbit.stable else "no")
    assert [line[0] for line in shown["impacts"].split("|")] == ["L", "R"]
    assert shown["max|x1|"] == f"{orbit.measures.max_abs_x1:.6g}"


def test_a_branch(orbit: Orbit) -> None:
    branch = Branch(orbit.word, "A", (orbit, orbit), (), (), ("range", "period_doubling"), remark="a < b & c")
    shown = facts(branch._repr_html_())
    assert shown == {
        "": "Branch of LR",
        "A": "from 0.02 to 0.02",
        "orbits": f"2, {2 * orbit.stable} of them stable",
        "symmetric": "yes",
        "met": "no bifurcation",
        "ends": "range|period doubling",
        "remark": "a < b & c",
    }


def test_a_trajectory() -> None:
    run: Trajectory = simulate(P, periods=20)
    shown = facts(run._repr_html_())
    assert shown[""] == "Trajectory over 20 forcing periods"
    left, right = (int(np.count_nonzero(run.impacts["side"] == side)) for side in (1, -1))
    assert shown["impacts"] == f"{left} on L, {right} on R"
    assert shown["status"] == "complete"


def test_an_attractor() -> None:
    found: Attractor = settle(P)
    largest = np.abs(found.multipliers).max() if found.multipliers is not None else np.nan
    said = repr(found)
    assert said.startswith(f"<Attractor {found.name} ({found.word}) at mu = 0.01, A = 0.02, ")
    assert "settled, asymmetric, K2/K1 " in said
    assert f"largest multiplier {largest:.6g}" in said
    assert len(said) < 250
    shown = facts(found._repr_html_())
    assert (shown[""], shown["settled"], shown["symmetric"]) == (f"{found.name} ({found.word})", "yes", "no")
    assert "reason" not in shown
