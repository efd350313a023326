"""What is in a recording, told without drawing it."""

import subprocess
import sys

import numpy as np
import pytest
import rerun as rr

from vines import viewer
from vines.errors import FileMissingError, LogError, ViewerError
from vines.logs import read
from vines.viewer._clock import Clock
from vines.viewer._curves import balance
from vines.viewer._layout import _BEFORE, _WINDOW, _moment, _span
from vines.viewer._text import impact_lines


@pytest.fixture(autouse=True)
def strict():
    """Let a wrong use of Rerun raise, where it would only warn."""
    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)


def columns(table):
    return {name: table[name].to_numpy() for name in table.column_names}


def chunks(path):
    """Return the row counts of each entity of a recording, and its properties' entities."""
    counts: dict[str, int] = {}
    for chunk in rr.chunk.RrdReader(str(path)).stream().to_chunks():
        counts[chunk.entity_path] = max(counts.get(chunk.entity_path, 0), chunk.num_rows)
    return counts


def test_import_loads_nothing_heavy():
    code = (
        "import sys, vines.viewer; "
        "print([name for name in ('rerun', 'pyarrow', 'numba', 'matplotlib') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_recording_holds_every_state_and_impact(settled, tmp_path):
    log = read(settled)
    found = chunks(viewer.save_rrd([settled], tmp_path / "run.rrd"))
    root = "/quickstart_settled"
    for part in ("cavity/mass", "cavity/ball", "cavity/base", "cavity/spring", "phase/plane/now", "phase/plane/trail"):
        assert found[f"{root}/{part}"] == log.states.num_rows, part
    for part in ("ends", "w/gap", "w_dot/rate", "energy", "balance"):
        assert found[f"{root}/{part}"] == log.states.num_rows, part
    left = int((log.impacts["side"].to_numpy() == 1).sum())
    assert left > 0
    assert found[f"{root}/w/left"] == found[f"{root}/ends/left"] == found[f"{root}/w_dot/left"] == left
    assert found[f"{root}/impacts"] == log.impacts.num_rows
    assert f"{root}/about" in found
    groups = [path.rsplit("/", 1)[1] for path in sorted(found) if path.startswith("/__properties/")]
    assert groups == ["from", "given", "got", "vines"]  # the order of the columns of `vines browse`


def test_several_runs_keep_apart(settled, chatter, tmp_path):
    found = chunks(viewer.save_rrd([settled, chatter, settled], tmp_path / "runs.rrd"))
    for root in ("quickstart_settled", "quickstart_chatter", "quickstart_settled_2"):
        assert f"/{root}/cavity/ball" in found


def test_run_without_impacts_sends_no_empty_rows(no_impact, tmp_path):
    found = chunks(viewer.save_rrd([no_impact], tmp_path / "run.rrd"))
    assert "/quickstart_no_impact/impacts" not in found
    assert all(rows > 0 for rows in found.values())


def test_nothing_to_show_is_said(empty, tmp_path):
    with pytest.raises(ViewerError, match="holds no states"):
        viewer.save_rrd([empty], tmp_path / "run.rrd")
    with pytest.raises(ViewerError, match="no log was named"):
        viewer.save_rrd([], tmp_path / "run.rrd")
    assert list(tmp_path.iterdir()) == []


def test_bad_input_leaves_what_was(settled, tmp_path):
    out = tmp_path / "run.rrd"
    out.write_bytes(b"before")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(settled.read_bytes()[:-100])
    with pytest.raises(LogError, match="cut short"):
        viewer.save_rrd([cut], out)
    with pytest.raises(FileMissingError, match="there is no log"):
        viewer.save_rrd([tmp_path / "no.mcap"], out)
    with pytest.raises(FileMissingError, match="create it first"):
        viewer.save_rrd([settled], tmp_path / "no" / "run.rrd")
    assert out.read_bytes() == b"before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut.mcap", "run.rrd"]


@pytest.mark.parametrize("log", ["settled", "chatter"])
def test_balance_closes(log, request):
    parts = balance(columns(read(request.getfixturevalue(log)).states))
    rest = parts["base_work"] - parts["damper_loss"] - parts["impact_loss"] - parts["stored"]
    assert np.abs(rest).max() < 1e-12
    assert all(values[0] == 0.0 for values in parts.values())


def test_cycles_agree_with_the_phase(settled):
    states = columns(read(settled).states)
    clock = Clock(float(states["t"][0]), float(states["phase"][0]), 1.0)
    off = clock.cycles(states["t"]) - states["phase"] / (2 * np.pi)
    np.testing.assert_allclose(off, np.rint(off), atol=1e-12)
    assert len(clock.columns(states["t"])) == 2
    assert len(Clock(0.0, 0.0, None).columns(states["t"])) == 1


def test_window_opens_on_data_in_forcing_cycles():
    """Without a still: the cursor stands on the first state, so the span of a long run lies after it."""
    run = viewer.Shown("/run", "run", 0.0, 60.0 * 6.28, 0.0, 60.0, period=6.28)
    assert run.timeline == "cycle/1000"
    before, after = (_span(run, part)["seq"] for part in (-_BEFORE * _WINDOW, (1 - _BEFORE) * _WINDOW))
    assert after - before == 20_000
    assert -before < 0.1 * after
    rig = viewer.Shown("/rig", "rig", 0.0, 3.0, 0.0, 3.0, period=1.0, kind="rig", parts=("base",), timeline="sim_time")
    assert _moment(rig, 0.5) == {"seconds": 1.5}


def test_impacts_in_words(settled):
    impacts = columns(read(settled).impacts)
    line = impact_lines(impacts)[0]
    before, after = impacts["w_dot"][0], -0.65 * impacts["w_dot"][0]
    assert f"w' {before:+.4f} → {after:+.4f}" in line
    assert line.startswith(f"t {impacts['t'][0]:.4f}")


def test_unknown_name_of_the_room():
    with pytest.raises(AttributeError, match="nothing_like_it"):
        _ = viewer.nothing_like_it
