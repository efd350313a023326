"""A run with several balls in the viewer: a track a cavity with its label, marks by ball and side."""

import numpy as np
import pytest
import rerun as rr

import vines
from tests.viewer.conftest import write
from vines import logs, viewer
from vines.systems import Parallel
from vines.viewer._balls import track_labels
from vines.viewer._layout import Shown, blueprint
from vines.viewer._program import headless
from vines.viewer._scene import cavity_bounds
from vines.viewer._show import _at_rest

THREE = Parallel(mu=(0.01, 0.01, 0.004), beta=(1.0, 0.8, 1.2), r=(0.3, 0.65, 0.5), A=0.02, G=0.01)
LABELS = (
    *("ball 1, mu = 0.01, beta = 1, r = 0.3", "ball 2, mu = 0.01, beta = 0.8, r = 0.65"),
    "ball 3, mu = 0.004, beta = 1.2, r = 0.5",
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    run = vines.simulate(THREE, v2=(0.1, -0.3, 0.1), periods=12)
    return logs.write_run(
        tmp_path_factory.mktemp("balls") / "three.mcap",
        states=run.sample(per_period=60, at_events=True),
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={},
        parameters=THREE.as_dict(),
        name="three",
        system="parallel",
    )


def views(part):
    """Return origin and name of every view of a layout, in its order."""
    if hasattr(part, "origin"):
        return [(part.origin, part.name)]
    return [each for inner in getattr(part, "contents", ()) for each in views(inner)]


@pytest.mark.parametrize("runs", [1, 2])
def test_the_layout_has_a_track_a_cavity_with_its_label(path, runs):
    labels = track_labels(logs.read(path))
    assert labels == LABELS
    shown = [Shown(f"/run_{k}", "three", 0.0, 75.0, 0.0, 12.0, 6.28, parts=labels) for k in range(runs)]
    found = views(blueprint(shown).root_container)
    for run in shown:
        tracks = [(origin, name) for origin, name in found if origin.startswith(f"{run.root}/track")]
        assert tracks == [
            (f"{run.root}/track_{k}", f"Cavity and ball, to scale: {label}") for k, label in enumerate(labels, 1)
        ]
    assert not any(origin.endswith(("/cavity", "/ends")) for origin, _ in found)


def test_the_recording_holds_every_state_and_impact_of_each_ball(path, tmp_path):
    log = logs.read(path)
    counts: dict[str, int] = {}
    for chunk in rr.chunk.RrdReader(str(viewer.save_rrd([path], tmp_path / "run.rrd"))).stream().to_chunks():
        counts[chunk.entity_path] = max(counts.get(chunk.entity_path, 0), chunk.num_rows)
    for ball, states in log.balls.items():
        for part in (f"track_{ball}/ball", f"track_{ball}/mass", f"phase/plane/ball_{ball}/now"):
            assert counts[f"/three/{part}"] == states.num_rows, part
        of_ball = log.impacts["ball"].to_numpy() == ball
        for letter, side in (("L", 1), ("R", -1)):
            own = int((of_ball & (log.impacts["side"].to_numpy() == side)).sum())
            assert own > 0
            for part in ("w", "w_dot", "lanes"):
                assert counts[f"/three/{part}/{letter}{ball}"] == own, part
    stuck = {f"{letter}{ball}" for ball, states in log.balls.items()
             for letter, side in (("L", 1), ("R", -1)) if (states["stuck"].to_numpy() == side).any()}  # fmt: skip
    assert stuck
    assert {path.rsplit("_", 1)[-1] for path in counts if "/lanes/stuck_" in path} == stuck
    assert counts["/three/impacts"] == log.impacts.num_rows


def test_views_of_cavities_show_the_longest():
    (left, right), _ = cavity_bounds(0.5, 1.4)
    (short_left, short_right), _ = cavity_bounds(0.5)
    assert np.allclose((short_left - left, right - short_right), 0.4)


def test_runs_of_several_balls_are_laid_over_each_other(path, tmp_path):
    """A view a ball; a run of one ball laid over it shares the view of ball 1."""
    one = write(tmp_path / "one.mcap", vines.simulate(vines.Params(mu=0.01, A=0.03), periods=4))
    counts: dict[str, int] = {}
    both = viewer.save_rrd([path, one], tmp_path / "both.rrd", overlay=True)
    for chunk in rr.chunk.RrdReader(str(both)).stream().to_chunks():
        counts[chunk.entity_path] = max(counts.get(chunk.entity_path, 0), chunk.num_rows)
    drawn = {name.removeprefix("/overlay/") for name in counts if name.startswith("/overlay/")}
    assert {"w_1/run_0", "w_2/run_0", "w_3/run_0", "x1/run_0", "w_1/run_1", "x1/run_1", "plane/up/run_0"} <= drawn
    assert "w_2/run_1" not in drawn
    assert counts["/overlay/w_3/run_0"] == logs.read(path).states.num_rows


@pytest.mark.long(8)
@pytest.mark.usefixtures("vulkan")
def test_views_draw_without_errors(path, tmp_path):
    with headless(viewer.save_rrd([path], tmp_path / "run.rrd"), (600, 400)) as client:
        _at_rest(client)
        state = client.get_state()
        assert sum("/track_" in view.origin for view in state.views) == 3
        assert [report for view in state.views for report in view.reports] == []
