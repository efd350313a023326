"""Logs of real runs: settled, with an asymmetric 1:1, from rest, with chatter and a stick; of a rig; and a screen."""

import os

import numpy as np
import pytest

from vines import viewer
from vines.dynamics import simulate
from vines.errors import ViewerError
from vines.logs import Sensor, write_rig, write_run
from vines.model import Params
from vines.schema import numpy_dtype
from vines.viewer._program import headless


def write(path, run, **changes):
    arrays = {
        "states": run.sample(per_period=60, at_events=True),
        "impacts": run.impacts,
        "sticks": run.sticks,
        **changes,
    }
    return write_run(
        path,
        **arrays,
        provenance={"stage": f"quickstart.{path.stem}", "key": "0f"},
        parameters=run.params.as_dict(),
        name=f"quickstart.{path.stem}",
        attractor={"settled": "1:1"}.get(path.stem),
    )


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("logs")


@pytest.fixture(scope="session")
def settled_run():
    p = Params(mu=0.01, A=0.020, Omega=1.0, r=0.65)
    state = simulate(p, periods=500).final
    start = {name: state[name] for name in ("x1", "v1", "x2", "v2")}
    return simulate(p, **start, phi=state["phase"], periods=10)


@pytest.fixture(scope="session")
def settled(folder, settled_run):
    return write(folder / "settled.mcap", settled_run)


@pytest.fixture(scope="session")
def chatter(folder):
    return write(folder / "chatter.mcap", simulate(Params(mu=0.0084, A=0.015, Omega=1.0, r=0.65), periods=12))


@pytest.fixture(scope="session")
def no_impact(folder):
    run = simulate(Params(mu=0.01, A=0.001, Omega=1.0, r=0.65), v2=0.0, periods=3)
    assert len(run.impacts) == 0
    return write(folder / "no_impact.mcap", run)


@pytest.fixture(scope="session")
def empty(folder, settled_run):
    return write(folder / "empty.mcap", settled_run, states=settled_run.sample(per_period=60)[:0])


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    """Return the log of one sensor and of the base."""
    samples = np.zeros(400, numpy_dtype("vines.v1.SensorSample"))
    samples["t"] = np.arange(400) / 100.0
    samples["value"], samples["valid"] = 1e-3 * np.sin(55.0 * samples["t"]), 1
    base = np.zeros(400, numpy_dtype("vines.v1.BaseMotion"))
    base["t"], base["displacement"] = samples["t"], 1e-4 * np.sin(55.0 * samples["t"])
    base["velocity"] = base["acceleration"] = np.nan
    about = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "100"}
    path = tmp_path_factory.mktemp("rig") / "run.mcap"
    sensors = {"lo_disp": Sensor(samples, about)}
    return write_rig(path, sensors=sensors, base=base, provenance={}, parameters={"M [kg]": 3.8}, name="run_1")


@pytest.fixture(scope="session")
def other(tmp_path_factory):
    """Return a second run with the same forcing."""
    run = simulate(Params(mu=0.01, A=0.019, Omega=1.0, r=0.65), periods=8)
    return write(tmp_path_factory.mktemp("other") / "model.mcap", run)


@pytest.fixture(scope="session")
def vulkan(settled, tmp_path_factory):
    """Skip, aloud, where there is no Vulkan; never on a CI machine, which must have one."""
    try:
        with headless(viewer.save_rrd([settled], tmp_path_factory.mktemp("vulkan") / "run.rrd"), (400, 300)):
            pass
    except ViewerError as missing:
        if "no graphics adapter" in str(missing) and not os.environ.get("CI"):
            pytest.skip(f"the viewer cannot draw on this machine: {missing}")
        raise
