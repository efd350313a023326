"""Synthetic runs that the tests of the room share: a short one as a folder, and a dwell on 1:1 in memory."""

import pytest

from vines.rig import reconstruct, ring_down
from vines.rig.synth import RigSettings, make_run, raw_run, read_raw, simulate_rig

DWELL = RigSettings(duration=12.0, settle=30.0, sigma_r=0.01)
SHORT = RigSettings(duration=4.0, settle=1.0, rate=12800.0)


@pytest.fixture(scope="session")
def short_run(tmp_path_factory):
    """Return a run folder, not to be changed, and its truth."""
    folder = tmp_path_factory.mktemp("rig") / "run_1"
    return folder, make_run(folder, SHORT, 1).truth


@pytest.fixture(scope="session")
def ringdown():
    """Return omega0 and lam as ten seconds without the ball give them."""
    settings = RigSettings(
        run_id="free", protocol="ringdown", ball=False, E=0.0, duration=10.0, settle=0.0, start=(0.004, 0.0, 0.0, 0.0)
    )
    return ring_down(simulate_rig(settings, 1)[0])


@pytest.fixture(scope="session")
def raw():
    """Return a raw run of twelve seconds, not to be changed."""
    return raw_run(DWELL, 7)


@pytest.fixture(scope="session")
def dwell(raw, ringdown):
    """Return it reconstructed."""
    return reconstruct(read_raw(raw), [ringdown])
