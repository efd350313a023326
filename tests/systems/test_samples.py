"""What runs of several balls do not give is refused in a line."""

import pytest

import vines
from vines.errors import StateError
from vines.systems import Parallel


def test_runs_of_several_balls_have_no_samples():
    run = vines.simulate(Parallel(mu=(0.01, 0.01), A=0.03), v2=(0.1, -0.3), periods=2)
    with pytest.raises(StateError, match="no samples between events") as caught:
        run.sample(10)
    assert "\n" not in str(caught.value)
