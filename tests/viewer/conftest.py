"""Logs of real runs: settled, with an asymmetric 1:1, and from rest, with chatter and a stick."""

import pytest

from vines.dynamics import simulate
from vines.logs import write_run
from vines.model import Params


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
