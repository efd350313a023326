"""The time that a picture shows lies in the run; else a line says when that is, before any viewer starts."""

import re

import pytest

from vines import viewer
from vines.errors import ParameterError


@pytest.mark.parametrize("at", [-1.0, 1e6])
def test_a_time_outside_the_run(no_impact, tmp_path, at):
    with pytest.raises(ParameterError, match=re.escape(f"at is {at:g}, allowed is 0 to 18.8496, the time of the run")):
        viewer.screenshot([no_impact], tmp_path / "late.png", at=at)
    assert not list(tmp_path.iterdir())
