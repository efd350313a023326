"""Near a period doubling an orbit is named with its own period, not with twice that."""

import pytest

from vines.attractors import settle, settle_from
from vines.model import Params


@pytest.mark.parametrize("tolerance", [1e-9, 1e-10, 1e-11])
def test_a_multiplier_near_minus_one_does_not_double_the_period(tolerance):
    p = Params(mu=0.01, A=0.02145)
    found = settle_from(p, settle(p.replace(A=0.0214)).final, tolerance=tolerance)
    assert (found.name, found.settled) == ("4:4/4T", True)
    assert found.multipliers[0].real == pytest.approx(-0.98273, abs=1e-5)
    # The same orbit from rest, far on.
    assert settle(p, settle=5000).name == "4:4/4T"


def test_beyond_the_doubling_it_is_doubled():
    assert settle(Params(mu=0.01, A=0.02146)).name == "8:8/8T"
