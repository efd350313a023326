"""What tests of stages share: pictures without what takes long to draw."""

from unittest import mock

import pytest

from vines.figures._style import RC

COARSE_LOOK = {
    "xtick.minor.visible": False,
    "ytick.minor.visible": False,
    "savefig.dpi": 60,
    "svg.fonttype": "none",
    "pdf.fonttype": 3,
}
"""Most of the time of drawing goes into minor ticks, pixels, outlines and subsets of fonts, which say nothing about a
stage."""


@pytest.fixture(scope="module")
def coarse_look():
    """Draw quickly what the tests of a file draw in this process; tests of figures look at the real thing."""
    with mock.patch.dict(RC, COARSE_LOOK):
        yield
