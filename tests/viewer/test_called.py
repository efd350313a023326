"""What the viewer says and draws of other systems: names of bodies, barriers, stops in mid-cavity."""

import matplotlib.colors
import matplotlib.figure
import numpy as np
import pytest
import rerun as rr

from vines import viewer
from vines.dynamics import simulate
from vines.logs import Tail, read, write_run
from vines.systems import CubicBarriers, Friction
from vines.viewer._called import Called, called, called_in, stops_of
from vines.viewer._film import Film

SLIDES = Friction(mu=0.1, A=0.2, r=0.7, f=0.3)


def logged(folder, run, name):
    p = run.params
    return write_run(
        folder / f"{name}.mcap",
        states=run.sample(per_period=40, at_events=True),
        impacts=run.impacts,
        sticks=run.rests,
        provenance={},
        parameters=p.as_dict(),
        name=name,
        system=p.system.name,
    )


@pytest.fixture(scope="module")
def sliding():
    return simulate(SLIDES, v2=0.1, periods=12)


def test_rests_are_the_spells_without_motion_against_the_cavity(sliding):
    rests = sliding.rests
    stops = rests[rests["side"] == 0]
    assert len(stops) > 3
    assert np.all(np.diff(rests["t_start"]) >= 0)
    assert np.array_equal(rests[rests["side"] != 0], sliding.sticks)
    events = sliding.events
    assert np.array_equal(stops["t_start"], events["t"][events["kind"] == 5])
    for spell in stops[~np.isnan(stops["t_release"])]:
        inside = sliding.sample(times=np.linspace(spell["t_start"] + 1e-9, spell["t_release"] - 1e-9, 5))
        assert np.ptp(inside["w"]) == pytest.approx(0.0, abs=1e-12)
        later = sliding.sample(times=[min(spell["t_release"] + 1e-2, sliding.t_end)])
        assert abs(later["w_dot"][0]) > 0
    # Each stop and each new slide has its sample.
    assert np.isin(stops["t_start"], sliding.sample(per_period=40, at_events=True)["t"]).all()


def test_a_stop_is_drawn_grey_and_told(sliding, tmp_path):
    path = logged(tmp_path, sliding, "sliding")
    log = read(path)
    spells = stops_of(log)
    assert len(spells) == (sliding.rests["side"] == 0).sum()
    assert np.all(spells[:, 1] > spells[:, 0])
    rows: dict[str, int] = {}
    for chunk in rr.chunk.RrdReader(str(viewer.save_rrd([path], tmp_path / "run.rrd"))).stream().to_chunks():
        rows[chunk.entity_path] = max(rows.get(chunk.entity_path, 0), chunk.num_rows)
    for part in ("lanes/stopped", "w/stopped", "w_dot/stopped"):
        assert rows[f"/sliding/{part}"] == 3 * len(spells), part
    assert "/sliding/phase/plane/stops" in rows
    middle = float(spells[1].mean())
    film = Film(matplotlib.figure.Figure(), log, np.array([middle, spells[1, 1] + 0.05]))
    colours = []
    for k in (0, 1):
        film.show(k)
        colours.append(matplotlib.colors.to_hex(film._balls[0][0].get_facecolor()))
    assert colours == ["#8f949c", "#e69f00"]


def test_a_mass_on_a_spring_is_no_ball(sliding, settled, tmp_path):
    assert called(read(settled)) == Called()
    assert called(read(logged(tmp_path, sliding, "sliding"))).lost == "lost in damper and friction"
    for walls, drawing, ends in (
        (True, "Barriers and mass, to scale", "Barriers x1 ± 1 and mass x2"),
        (False, "Oscillator and mass, to scale", "Oscillator x1 and mass x2"),
    ):
        p = CubicBarriers(mu=0.02, A=0.01, k3=1.0, l2=0.1, walls=walls)
        path = logged(tmp_path, simulate(p, v2=0.4, periods=3), f"cubic_{walls}")
        names = called(read(path))
        assert (names.body, names.drawing, names.ends) == ("mass", drawing, ends)
        assert names.lost == "lost in damper and dashpot"
        tail = Tail(path)
        tail.take()
        assert called_in(tail.system, tail.parameters) == names
        assert "ball" not in f"{names.lanes} {names.gap} {names.stored} {names.frame}"
        found = [
            chunk.entity_path
            for chunk in rr.chunk.RrdReader(str(viewer.save_rrd([path], tmp_path / "run.rrd"))).stream().to_chunks()
        ]
        assert (f"/cubic_{walls}/cavity/mass/left" in found) == walls
