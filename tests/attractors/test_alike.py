"""Which attractors are one."""

import pytest

from vines.attractors import SAME, Motion, apart

PERIODIC = {"regime": "periodic", "name": "2:1", "n": 2, "m": 1, "p": 1, "kinetic_ratio": 1.0, "max_abs_x1": 0.5}
CHAOTIC = {
    **{"regime": "chaotic", "name": None, "n": None, "m": None, "p": None, "kinetic_ratio": 1.0, "max_abs_x1": 0.5},
    **{"kinetic_ratio_error": 0.01, "rms_x1": 0.3, "rms_x1_error": 0.01},
}


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        (PERIODIC, {**PERIODIC, "n": 1, "m": 2}, True),  # mirror images
        (PERIODIC, {**PERIODIC, "p": 2}, False),
        (PERIODIC, {**PERIODIC, "max_abs_x1": 0.51}, False),
        (PERIODIC, CHAOTIC, False),
        (CHAOTIC, {**CHAOTIC, "regime": "unsettled"}, True),
        (CHAOTIC, {**CHAOTIC, "kinetic_ratio": 1.3}, True),  # one measure alone may be chance
        (CHAOTIC, {**CHAOTIC, "kinetic_ratio": 1.3, "rms_x1": 0.5}, False),
        (CHAOTIC, {"regime": "chaotic", "kinetic_ratio": 1.3, "rms_x1": 0.5, "max_abs_x1": 1}, True),  # no errors known
        (CHAOTIC, {**CHAOTIC, "regime": "quasiperiodic"}, False),
    ],
)
def test_one_attractor_up_to_mirror_image(a, b, same):
    one, other = Motion.of_row(a), Motion.of_row(b)
    assert (apart(one, other) <= SAME) == (apart(other, one) <= SAME) == same


def test_the_distance_of_periodic_attractors_is_relative_to_one_and_their_size():
    one = Motion("periodic", 1, 1, 1, kinetic_ratio=1.0, max_abs_x1=0.5)
    assert apart(one, one._replace(kinetic_ratio=1.002)) == pytest.approx(0.001)
    assert apart(one, one._replace(max_abs_x1=0.503)) == pytest.approx(0.002)
