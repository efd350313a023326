"""Logs of several balls: every channel is what the run says, damage is told, and other logs are as before."""

from xml.etree import ElementTree

import numpy as np
import pytest
from mcap.reader import make_reader

import vines
from vines import logs
from vines.errors import LogError, SchemaError
from vines.systems import Parallel

TWO = Parallel(mu=(0.01, 0.01), beta=(1.0, 1.4), r=(0.3, 0.65), A=0.02, G=0.01)
OSCILLATOR = ("t", "x1", "v1", "phase", "base", "kinetic_1", "potential", "base_work", "damper_loss", "impact_loss")
BALL = ("x2", "v2", "w", "w_dot", "kinetic_2", "potential_2", "stuck")


@pytest.fixture(scope="module")
def run():
    run = vines.simulate(TWO, v2=(0.1, -0.3), periods=30)
    assert set(run.impacts["ball"]) == {1, 2}
    assert len(run.sticks)
    return run


@pytest.fixture(scope="module")
def states(run):
    return run.sample(per_period=100, at_events=True)


@pytest.fixture(scope="module")
def path(run, states, tmp_path_factory):
    return write(tmp_path_factory.mktemp("balls") / "two.mcap", run, states)


def write(path, run, states, **more):
    return logs.write_run(
        path,
        **more,
        states=states,
        impacts=run.impacts,
        sticks=run.sticks,
        provenance={"stage": "two"},
        parameters=run.params.as_dict(),
        name="two",
        system=run.params.system.name,
    )


def assert_is(table, rows, names, columns=None):
    assert table.column_names == list(names)
    for name, column in zip(names, columns or names, strict=True):
        np.testing.assert_array_equal(table[name].to_numpy(), rows[column])


def test_every_channel_is_what_the_run_says(run, states, path):
    log = logs.read(path)
    assert (log.system, log.kind, log.status, log.remarks) == ("parallel", "run", "complete", ())
    assert log.parameters == TWO.as_dict()
    assert_is(log.states, states, OSCILLATOR)
    assert list(log.balls) == [1, 2]
    for ball, table in log.balls.items():
        assert_is(table, states, ("t", *BALL), ("t", *(f"{name}_{ball}" for name in BALL)))
    assert {"ball", "ties"} < set(log.impacts.column_names)
    assert_is(log.impacts, run.impacts, log.impacts.column_names)
    assert_is(log.sticks, run.sticks, log.sticks.column_names)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    topics = sorted(channel.topic for channel in summary.channels.values())
    bare = {"/curves", "/impact_log", "/robot_description", "/tf", "/tf_static"}
    assert set(topics) - bare == {"/ball/1", "/ball/2", "/impact", "/oscillator", "/stick"}


def test_the_same_run_gives_the_same_bytes(run, states, path, tmp_path):
    assert write(tmp_path / "again.mcap", run, states).read_bytes() == path.read_bytes()


def test_a_damaged_log_is_recovered(states, path, tmp_path):
    data = path.read_bytes()
    hurt = tmp_path / "hurt.mcap"
    hurt.write_bytes(data[: 2 * len(data) // 3])
    with pytest.raises(LogError, match="cut short"):
        logs.read(hurt)
    said = logs.recover(hurt)
    log = logs.read(said.path)
    assert (log.status, log.system, list(log.balls)) == ("recovered", "parallel", [1, 2])
    assert 100 < log.states.num_rows < len(states)
    for ball, table in log.balls.items():
        assert any(line.startswith(f"/ball/{ball}: {table.num_rows} messages") for line in said.saved)
        assert_is(table, states[: table.num_rows], ("t", *BALL), ("t", *(f"{name}_{ball}" for name in BALL)))


@pytest.mark.parametrize("topic", ["/ball/2", "/oscillator"])
def test_a_lost_description_is_made_anew(path, tmp_path, topic):
    data = bytearray(path.read_bytes())
    data[data.index(topic.encode())] ^= 0xFF
    hurt = tmp_path / "hurt.mcap"
    hurt.write_bytes(data)
    log = logs.read(logs.recover(hurt).path)
    whole = logs.read(path)
    assert log.states.equals(whole.states)
    assert log.balls[1].equals(whole.balls[1])
    assert log.balls[2].equals(whole.balls[2])


def test_states_of_half_a_ball_are_refused(run, states, tmp_path):
    names = [name for name in states.dtype.names if name != "w_2"]
    with pytest.raises(SchemaError, match="states lack w_2"):
        write(tmp_path / "half.mcap", run, states[names])
    assert list(tmp_path.iterdir()) == []


def test_a_log_that_grows_with_its_run_is_the_log_of_the_whole_run(run, states, path, tmp_path):
    about = {"provenance": {"stage": "two"}, "parameters": TWO.as_dict(), "name": "two"}
    with logs.LiveWriter(tmp_path / "live.mcap", **about, system="parallel", balls=2) as live:
        for half in np.array_split(states, 2):
            live.add("states", half)
        live.add("impacts", run.impacts)
        live.add("sticks", run.sticks)
        with pytest.raises(SchemaError, match="no channel '1'; it has states, impacts, sticks"):
            live.add("1", states)
        with pytest.raises(SchemaError, match="x2_1"):
            live.add("states", states[list(OSCILLATOR)])
    ours, whole = logs.read(tmp_path / "live.mcap"), logs.read(path)
    assert (ours.system, list(ours.balls)) == ("parallel", [1, 2])
    assert ours.states.equals(whole.states)
    assert ours.impacts.equals(whole.impacts)
    assert ours.sticks.equals(whole.sticks)
    assert all(ours.balls[ball].equals(whole.balls[ball]) for ball in (1, 2))


def test_a_log_has_channels_for_as_many_balls_as_a_system_may_have(tmp_path):
    for wrong in (-1, 9):
        with pytest.raises(SchemaError, match="give 1 to 8"):
            logs.LiveWriter(tmp_path / "x.mcap", name="x", provenance={}, parameters={}, balls=wrong)


def test_the_profile_for_bare_viewers_shows_every_ball_in_its_cavity(run, states, path, tmp_path):
    seen = {}
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            seen.setdefault(channel.topic, []).append((message.log_time, message.data))
    kept = {}  # at an event there are two states, before and after
    for row in states:
        kept.setdefault(round(row["t"] * 1e9), []).append(row)
    assert len(seen["/tf"]) == len(seen["/curves"]) > 1000
    names = ("kinetic_1", "kinetic_2_1", "kinetic_2_2", "potential_2_1", "potential_2_2")
    for time, data in seen["/curves"]:
        last = np.frombuffer(data[-40:], "<f8")
        assert any(last == pytest.approx([row[name] for name in names], rel=1e-6) for row in kept[time])
    text = seen["/robot_description"][0][1].decode("utf-8", "ignore")
    geometry = ElementTree.fromstring(text[text.index("<robot") : text.rindex(">") + 1])
    assert [link.get("name") for link in geometry.iter("link")] == ["rig", "mass", "base", "ball_1", "ball_2"]
    ends = [float(each.get("xyz").split()[0]) for each in geometry.findall("link[@name='mass']/visual/origin")]
    # the ball's radius and half an end farther out than where the ball turns
    assert ends == [-1.16, 1.16, 0.0, -1.56, 1.56, 0.0]
    heights = {link: geometry.find(f"link[@name='{link}']/visual/origin").get("xyz") for link in ("ball_1", "ball_2")}
    assert heights == {"ball_1": "0 0 0", "ball_2": "0 0 -1"}
    assert all(f"ball_{k}".encode() in seen["/tf"][0][1] for k in (1, 2))
    lines = b" ".join(data for _, data in seen["/impact_log"])
    assert all(letter in lines for letter in (b"L1 impact", b"R1 impact", b"L2 impact", b"R2 impact", b"sticks after"))
    without = write(tmp_path / "without.mcap", run, states, bare=False)
    assert without.stat().st_size < path.stat().st_size
    assert logs.read(without).states.equals(logs.read(path).states)
