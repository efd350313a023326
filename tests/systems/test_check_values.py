"""The check values of the family, made by other programs, beside ours: the table of docs/systems.md line by line."""

import math
import re

import pytest

import vines
from tests.project import REPOSITORY
from vines.systems import CubicBarriers, ImpactPair, Parallel

pytestmark = pytest.mark.long(20)

PAGE = (REPOSITORY / "docs" / "systems.md").read_text("utf-8").partition("## Check values")[2]
ROWS = {row[0]: row[1:] for row in re.findall(r"^\| ([acdf]\w+) \| (.*?) \| (.*?) \| (.*?) \|$", PAGE, re.MULTILINE)}


def numbers(text):
    """Return the numbers of a cell as they are printed."""
    return re.findall(r"-?\d*\.\d+", text)


def balls(mu, beta, A, v2):
    found = vines.settle(Parallel(mu=mu, beta=beta, A=A), v2=v2, settle=1500, record=32)
    m = found.measures
    return [*(each.kinetic_ratio for each in m.balls), m.max_abs_x1]


def pair(B, G, word):
    orbit = vines.find_orbit(word, ImpactPair(B=B, G=G, r=0.5))
    return [*orbit.impacts["w_dot"].tolist(), orbit.measures.impact_loss / orbit.measures.duration]


def bifurcation(p, name, to, kind, word="LR"):
    branch = vines.continue_orbit(vines.find_orbit(word, p), name, to)
    return [next(each.value for each in branch.bifurcations if each.type == kind)]


def transient():
    found = vines.dynamics.decay(vines.simulate(Parallel(mu=(0.02,), A=0.0), v1=2.0, v2=[0.0], periods=20))
    return [found.energy * found.impact_share]


def symmetric():
    orbit = vines.find_orbit("LR", ImpactPair(B=0.6, G=0.0, r=0.5))
    first = orbit.multipliers[0]
    return [abs(orbit.impacts["w_dot"][0]), first.real, abs(first.imag)]


def not_quite_settled():
    m = vines.simulate(Parallel(mu=(0.01,), A=0.015), v2=[0.1], periods=400).measures(last=100)
    return [m.balls[0].kinetic_ratio, m.max_abs_x1]


def tilted():
    p = Parallel(mu=(0.01,), A=0.02, G=0.01)
    m = vines.simulate(p, v2=0.0, periods=1500).measures(last=100)
    return [m.balls[0].kinetic_ratio, m.max_abs_x1, *vines.find_orbit("L1R1", p).w_dot.tolist()]


def nearly_massless():
    """The VI-NES whose oscillator, without a ball, has the amplitude of the capsule."""
    given = {"mu": 1e-8, "Omega": 1.3, "r": 0.5}
    A = 0.5 / vines.dynamics.no_ball(vines.Params(A=1.0, **given))
    return [abs(vines.find_orbit("LR", vines.Params(A=A, **given)).w_dot[0]) / 1.3]


def spring(periods=1200, walls=True, **given):
    """Energies of the last hundred periods, and the last impacts."""
    run = vines.simulate(CubicBarriers(**given, walls=walls), periods=periods)
    m = run.measures(last=100)
    speeds = sorted(run.impacts["w_dot"][-2:].tolist(), reverse=True)
    powers = [each / m.duration for each in (m.viscous_loss, m.impact_loss, m.base_work)]
    return [m.kinetic_ratio, m.max_abs_x1, *speeds, *powers]


def some(values, *places):
    return [values[place] for place in places]


OURS = {
    "c1": lambda: spring(mu=0.01, A=0.02, k3=0.5, l2=0.05),
    "c3": lambda: some(spring(mu=0.02, A=0.03, k3=1.0, l2=0.2), 0, 1, 2, 4, 5),
    "c5": lambda: some(spring(mu=0.02, A=0.03, k3=0.25, l2=0.02), 0, 1, 2),
    "c8": lambda: some(spring(mu=0.05, A=0.05, k3=3.0, l2=0.2, walls=False), 0, 1),
    "cSB": lambda: bifurcation(CubicBarriers(mu=0.02, A=0.03, k3=1.0, l2=0.1), "A", 0.036, "symmetry_breaking"),
    "a1": lambda: balls((0.01, 0.01), (1.0, 1.0), 0.03, [0.1, -0.3]),
    "a3": lambda: balls((0.01, 0.01), (1.0, 1.4), 0.03, [0.1, -0.3]),
    "a5": lambda: balls((0.01, 0.01), (1.0, 1.0), 0.02, [0.1, -0.3]),
    "a7": lambda: balls((0.01, 0.006, 0.004), (1.0, 1.2, 1.4), 0.03, [0.1, -0.3, 0.2]),
    "alim": not_quite_settled,
    "aSB": lambda: bifurcation(Parallel(mu=(0.01,), A=0.016), "A", 0.02, "symmetry_breaking"),
    "aTET": transient,
    "d1": symmetric,
    "d2": lambda: bifurcation(ImpactPair(B=0.6, G=0.0, r=0.5), "B", 0.9, "symmetry_breaking"),
    "d3": lambda: pair(0.6, 0.05, "LR"),
    "d4": lambda: pair(0.95, 0.15, "LLR"),
    "d6": nearly_massless,
    "f1": tilted,
    "d5": lambda: bifurcation(ImpactPair(B=0.8, G=0.05, r=0.5), "B", 1.0, "period_doubling"),
}


def test_every_check_value_of_the_page_is_computed():
    assert set(ROWS) == set(OURS)


# three balls compile kernels of their own
@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.full if n == "a7" else ()) for n in sorted(OURS)])
def test_ours_is_the_check_value_to_the_digits_that_are_given(name):
    _, given, ours = ROWS[name]
    found, theirs, told = OURS[name](), numbers(given), numbers(ours)
    assert len(found) == len(theirs) == len(told)
    for value, check, text in zip(found, theirs, told, strict=True):
        # what the page says of ours is what comes out, but for the last digit of its print
        assert math.isclose(value, float(text), abs_tol=2 * 10.0 ** -len(text.partition(".")[2]))
        # and that is the check value, which may be off by as much
        assert math.isclose(value, float(check), abs_tol=4 * 10.0 ** -len(check.partition(".")[2]))
