"""One short synthetic run that the tests of ingest share."""

import pytest

from vines.rig.synth import RigSettings, make_run

SHORT = RigSettings(duration=4.0, settle=1.0, rate=12800.0)


@pytest.fixture(scope="session")
def short_run(tmp_path_factory):
    """Return a run folder, not to be changed, and its truth."""
    folder = tmp_path_factory.mktemp("rig") / "run_1"
    return folder, make_run(folder, SHORT, 1).truth
