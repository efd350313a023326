"""Parameters of the systems beside the VI-NES: validated, flat in the declared order, from SI units."""

import math
import pickle
import re

import numpy as np
import pytest

import vines
from vines.errors import ParameterError
from vines.systems import ImpactPair, Parallel, parameters

PAIR = ImpactPair(B=0.6, G=0.05, r=0.5)
THREE = Parallel(mu=(0.01, 0.006, 0.004), beta=(1, 1.2, 1.4), r=0.65, A=0.03)
EACH = pytest.mark.parametrize("p", [PAIR, THREE, vines.Params(mu=0.01, A=0.02)], ids=lambda p: p.system.name)


@EACH
def test_flat_names_arrays_and_objects_say_the_same(p):
    assert list(p.as_dict()) == [each.name for each in p.system.parameters]
    assert p.as_array().dtype == np.float64
    assert p.as_array().tolist() == list(p.as_dict().values())
    assert type(p).of(p.as_dict()) == p == pickle.loads(pickle.dumps(p))
    assert hash(type(p).of(p.as_dict())) == hash(p)
    assert parameters(p.system.name) is type(p)


@EACH
def test_they_are_frozen_and_replaceable_by_flat_names(p):
    name = p.system.parameters[-1].name
    assert p.replace(**{name: 0.25}).as_dict() == p.as_dict() | {name: 0.25}
    with pytest.raises(AttributeError):
        p.r = 0.3
    with pytest.raises(ParameterError, match="unknown parameter 'kappa'"):
        p.replace(kappa=1)


@EACH
def test_every_declared_range_is_kept_to_the_last_bit(p):
    for each in p.system.parameters:
        for end, out, side in (
            (each.allowed.least, each.allowed.above, -1),
            (each.allowed.most, each.allowed.below, 1),
        ):
            if not math.isinf(end):
                beyond = end if out else math.nextafter(end, side * math.inf)
                with pytest.raises(ParameterError, match=rf"^{each.name} is .*, allowed is .*{each.name}") as caught:
                    p.replace(**{each.name: beyond})
                assert "\n" not in str(caught.value)
        with pytest.raises(ParameterError, match=f"^{each.name} is nan; give a finite number"):
            p.replace(**{each.name: math.nan})


def test_the_order_is_the_declared_one():
    assert list(THREE.as_dict()) == [
        *("A", "Omega", "lam", "G", "mu_1", "mu_2", "mu_3", "beta_1", "beta_2", "beta_3", "r_1", "r_2", "r_3")
    ]
    assert list(PAIR.as_dict()) == ["B", "G", "r"]


def test_the_mirror_goes_with_the_tilt():
    assert (PAIR.mirrored, PAIR.replace(G=0).mirrored, THREE.mirrored, THREE.replace(G=0.01).mirrored) == (
        *(False, True, True, False),
    )


def test_equal_balls_are_found():
    assert THREE.alike == ()
    assert Parallel(mu=(0.01,) * 4, beta=(1, 1.2, 1, 1.2), A=0.03).alike == ((1, 3), (2, 4))


def test_si_units_by_hand():
    b, omega, tilt = 0.1, 15.7, 10.0
    p = ImpactPair.from_physical(half_length=b, omega=omega, amplitude=0.06, tilt=tilt, r=0.5)
    assert 0.06 / b == p.B
    assert math.isclose(p.G, 9.80665 * math.sin(math.pi / 18) / (b * omega**2), rel_tol=1e-15)
    rig = vines.PhysicalParams()
    q = Parallel.from_physical(m=(0.03, 0.02), E=0.3e-3, omega=rig.omega0, tilt=1.0, beta=(1, 1.4))
    assert q.mu == (0.03 / rig.M, 0.02 / rig.M)
    assert (q.A, q.Omega) == (0.02, 1.0)
    # systems.md, section 2: one degree on the rig of Table 1
    assert round(q.G, 4) == 0.0037


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: Parallel(mu=(), A=0.1), "mu has 0 values, allowed are 1 to 8: one a ball"),
        (lambda: Parallel(mu=(0.01,) * 9, A=0.1), "mu has 9 values"),
        (lambda: Parallel(mu="ab", A=0.1), "mu is 'ab'; give a number for each ball"),
        (lambda: Parallel(mu=(0.01, 0.01), beta=(1, 1, 1), A=0.1), "beta has 3 values for 2 balls"),
        (lambda: Parallel(mu=(0.01, -1), A=0.1), "mu_2 is -1, allowed is 0 <= mu_2 <= 1e+06: mu is the mass ratio m/M"),
        (lambda: Parallel.of({"A": 0.1, "mu_1": 0.1, "mu_3": 0.1}), "mu is given for the balls [1, 3]"),
        (lambda: Parallel.of({"mu_1": 0.1}), "A is missing"),
        (lambda: ImpactPair.of({"B": 0.1, "C": 0.1}), "unknown parameter 'C'"),
        (lambda: ImpactPair.from_physical(B=1.0, half_length=1.0, amplitude=1.0), "B is given, and follows from"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(call, text):
    with pytest.raises(ParameterError, match=re.escape(text)) as caught:
        call()
    assert "\n" not in str(caught.value)
