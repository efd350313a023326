"""A structure of several modes in pipelines: tables with the energies of modes, and what is refused."""

import math

import numpy as np
import pytest

import vines
from vines.errors import VinesError
from vines.logs import read
from vines.stages import load_pipeline, run, verify
from vines.systems import Modes

MODES = """
title = "two modes"
system = "modes"
[params]
mu = 0.05
omega = [1.0, 1.9]
phi = [0.8, -0.7]
gamma = [0.9, 0.5]
lam = [0.02, 0.05]
[stages.points]
kind = "sweep"
vary.A = [0.04]
carry = "A"
settle = 200
random = 1
[stages.run]
kind = "trajectory"
params.A = 0.04
settle = 100
record = 2
[stages.plane]
kind = "basins"
params.A = 0.04
settle = 60
x = { name = "x2", from = -0.9, to = 0.9, count = 2 }
y = { name = "q_2", from = -0.9, to = 0.9, count = 2 }
[stages.branch]
kind = "branch"
word = "LR"
points = 3
vary.A = { from = 0.038, to = 0.042 }
[stages.gone]
kind = "transient"
periods = 20
vary.V = [2.0]
"""
CURVE = """
[stages.curve]
kind = "curve"
word = "LR"
type = "symmetry_breaking"
vary.A = { from = 0.03, to = 0.06 }
vary.phi_2 = { from = -0.8, to = -0.6 }
"""


@pytest.fixture
def structure(project, monkeypatch):
    monkeypatch.setenv("VINES_ROOT", str(project.root))

    def declare(text):
        (project.root / "pipelines" / "structure.toml").write_text(text)
        return project

    return declare


@pytest.mark.long(30)
def test_tables_hold_the_energies_of_the_modes(structure):
    project = structure(MODES)
    run("structure")
    found = verify("structure", recompute=3)
    assert found.good, [line.first for line in found.lines if line.first]
    (log,) = (project.root / "data" / "results").rglob("*.mcap")
    assert read(log).system == "modes"
    points = {row["A"]: row for row in vines.query('select * from "structure.points"').to_pylist()}
    p = Modes(mu=0.05, A=0.04, omega=(1.0, 1.9), phi=(0.8, -0.7), gamma=(0.9, 0.5), lam=(0.02, 0.05))
    orbit = vines.find_orbit("LR", p)
    for k, each in enumerate(orbit.measures.modes, start=1):
        assert math.isclose(points[0.04][f"modal_energy_{k}"], each.kinetic + each.potential, rel_tol=1e-8)
        assert math.isclose(points[0.04][f"modal_loss_{k}"], each.damper_loss / orbit.period, rel_tol=1e-8)
    assert points[0.04]["modal_energy_3"] is None
    (gone,) = vines.table("modes_transients").to_pylist()
    shares = [gone[f"{name}_share"] for name in ("impact", "damper", "left")]
    assert math.isclose(sum(shares), 1, abs_tol=1e-12)


@pytest.mark.full
def test_a_curve_over_a_shape_is_followed_and_verified(structure):
    structure(MODES + CURVE)
    run("structure", stages=["curve"])
    assert len(vines.table("modes_curves").to_pylist()) > 3
    assert verify("structure").good


def test_the_cantilever_is_one():
    """Numbers of the pipeline are those of the closed form of its modes."""
    beta = np.array([1.8751040687119611, 4.694091132974175])
    assert np.cosh(beta) * np.cos(beta) == pytest.approx(-1, abs=1e-12)
    sigma = (np.cosh(beta) + np.cos(beta)) / (np.sinh(beta) + np.sin(beta))

    def shape(place):
        y = np.multiply.outer(place, beta)
        return np.cosh(y) - np.cos(y) - sigma * (np.sinh(y) - np.sin(y))

    x, weight = np.polynomial.legendre.leggauss(40)
    along, weight = 0.5 + 0.5 * x, 0.5 * weight
    assert weight @ shape(along) ** 2 == pytest.approx(1, abs=1e-12)
    omega, gamma = (beta / beta[0]) ** 2, weight @ shape(along)
    node = shape(0.7834445505005600)
    assert node[1] == pytest.approx(0, abs=1e-12)
    phi = {"tip": (2.0, -2.0), "none": (2.0, -2.0), "node": (node[0], 0.0)}
    for name, stage in load_pipeline("cantilever").stages.items():
        if stage.kind.name == "sweep":
            for k in (0, 1):
                known = [omega[k], gamma[k], 0.02 * omega[k], phi[name.partition("_")[0]][k]]
                given = [stage.params[f"{each}_{k + 1}"] for each in ("omega", "gamma", "lam", "phi")]
                assert given == pytest.approx(known, abs=1e-11)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("mu = 0.05", "mu = 0.05\nmodes = 3", "omega has 2 values, and modes = 3"),
        ("mu = 0.05", "mu = 0.05\nballs = 2", "balls"),
        ("phi = [0.8, -0.7]", "phi = [0.0, -0.7]", "phi_1 is 0"),
        ("phi = [0.8, -0.7]", "phi = [0.8]", "params.phi is a list of 1, and there are 2 modes"),
        ('kind = "branch"', 'kind = "reduced"', "the kind 'reduced' cannot do the system 'modes'"),
        ('word = "LR"', 'word = "L*R"', "L*R"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(structure, old, new, text):
    structure(MODES.replace(old, new))
    with pytest.raises(VinesError, match=text.replace("*", r"\*")):
        load_pipeline("structure")
