"""A campaign: what runs share is said once; recordings say what they know; what differs has a reason."""

import json
import shutil

import msgspec
import numpy as np
import pytest

from vines.errors import RigError, StoreError
from vines.rig import find_runs, init_campaign, init_run, read_folder, read_run
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import Ingested
from vines.rig.records import channel_rows, run_row
from vines.rig.synth import RigSettings, make_run, raw_run
from vines.rig.synth._write import write_raw

LIGHT = {"duration": 4.0, "rate": 12800.0, "u_temperature": 0.0}
FREE = RigSettings(protocol="ringdown", ball=False, E=0.0, settle=0.0, start=(0.012, 0.0, 0.0, 0.0), **LIGHT)
FORCED = RigSettings(settle=1.0, **LIGHT)
PLAN = {
    "00_free": "ringdown", "01": "sweep_up", "02": "sweep_up", "03": "sweep_up", "04": "sweep_down",
    "05": "sweep_down", "06": "sweep_down", "07_free": "ringdown",
}  # fmt: skip
"""The campaign of issue 19: six runs and two ring-downs."""


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """Return a folder of eight recordings and a run folder, filled in by hand, that six of them are copies of."""
    place = tmp_path_factory.mktemp("laboratory")
    run, free = make_run(place / "runs" / "forced", FORCED, 5), raw_run(FREE, 5)
    (place / "recordings").mkdir()
    # The synthetic laboratory takes other sensors for a ring-down; here they stay where they are.
    more = {row.field: row.sensitivity / other.sensitivity for row, other in zip(run.rows, free.rows, strict=True)}
    still = tuple(
        RawChannel(
            each.name,
            np.round(each.values * more[each.name]).astype(np.int32),
            "V",
            each.rate,
            each.start,
            about=each.about,
        )
        for each in free.files["run.tdms"].channels
    )
    for name, protocol in PLAN.items():
        recording = place / "recordings" / f"{name}.tdms"
        if protocol == "ringdown":
            write_raw(recording, "tdms", RawFile("tdms", still, FREE.start_utc))
        else:
            shutil.copy(place / "runs" / "forced" / "raw" / "run.tdms", recording)
    return place


class Typist:
    """Fills in forms as a person does, and counts each entry."""

    def __init__(self):
        self.entries = 0

    def json(self, path, **values):
        form = json.loads(path.read_text())
        for key, value in values.items():
            name, _, part = key.partition("__")
            self.entries += len(value) if isinstance(value, dict) else 1
            if part:
                form[name][part] = value
            else:
                form[name] = value
        path.write_text(json.dumps(form))

    def cell(self, path, row, column, value):
        lines = path.read_text().splitlines()
        (head,) = (k for k, line in enumerate(lines) if line.startswith("name\t"))
        place = lines[head].split("\t").index(column)
        for k in range(head + 1, len(lines)):
            cells = lines[k].split("\t")
            if cells[0] == row and cells[place] != value:
                cells[place] = value
                self.entries += 1
                lines[k] = "\t".join(cells)
        path.write_text("\n".join(lines) + "\n")


def fill(campaign, laboratory, typist):
    """Type in what the folders that were filled in by hand say."""
    wanted = read_folder(laboratory / "runs" / "forced")
    form = wanted.form
    both = {name: msgspec.to_builtins(getattr(form, name)) for name in ("M", "m", "b")}
    friction = form.more["friction"]
    typist.json(campaign / "rig.json", f_cmd=form.f_cmd, settle=form.settle, more__friction=friction, **both)
    table = campaign / "channels.tsv"
    for column, value in (("sign", "+1"), ("range", "10"), ("u_delay", "2e-06")):
        typist.cell(table, "*", column, value)
    for row in wanted.rows:
        for column in ("sensitivity", "sensitivity_unit", "u_sensitivity", "group_delay"):
            typist.cell(table, row.name, column, str(getattr(row, column)))
        if row.high_pass:
            typist.cell(table, row.name, "high_pass", repr(row.high_pass))
    for name, protocol in PLAN.items():
        own = {"temperature_before": 20.0, "temperature_after": 20.0}
        if protocol != "ringdown":
            own |= {"protocol": protocol, "E_cmd": form.E_cmd}
        typist.json(campaign / name / "run.json", **own)


@pytest.fixture(scope="module")
def campaign(laboratory, tmp_path_factory):
    """Return a campaign that is filled in, and how many entries that took."""
    place = tmp_path_factory.mktemp("campaign") / "march"
    typist = Typist()
    typist.entries += 1  # the folder of recordings, on the command line
    init_campaign(place, [laboratory / "recordings"])
    fill(place, laboratory, typist)
    return place, typist.entries


def test_six_runs_and_two_ring_downs_take_sixty_entries_at_most(campaign, laboratory):
    place, entries = campaign
    assert entries <= 60
    wanted = read_run(laboratory / "runs" / "forced")
    for path in find_runs(place):
        found = read_run(path)
        assert found.recording.run.run_id == path.name
        assert found.recording.run.protocol == PLAN[path.name]
        assert found.recording.run.ball == (PLAN[path.name] != "ringdown")
        assert found.recording.run.M == wanted.recording.run.M
        if not found.recording.run.ball:
            assert found.recording.run.f_cmd is None
            continue
        for name, channel in wanted.recording.channels.items():
            assert np.array_equal(channel.values, found.recording.channels[name].values)
            assert channel.rate == found.recording.channels[name].rate


def test_where_each_value_stands_is_in_the_tables(campaign):
    place, _ = campaign
    found = read_run(place / "01")
    row = run_row(found)
    assert "rig.json: f_cmd, settle, M, m, b" in row["came_from"]
    assert "run.json: " in row["came_from"]
    assert "proposed by recording 01.tdms, its start: start_utc" in row["came_from"]
    assert row["overruled"] == ""
    (cell,) = (each for each in channel_rows(found) if each["channel"] == "lo_acc")
    assert "campaign: " in cell["came_from"]
    assert "proposed by recording 00_free.tdms, name and unit: role" in cell["came_from"]


@pytest.fixture
def one(campaign, tmp_path):
    """Return a campaign of one run that may be changed."""
    place = tmp_path / "march"
    place.mkdir()
    for name in ("rig.json", "channels.tsv"):
        shutil.copy(campaign[0] / name, place / name)
    shutil.copytree(campaign[0] / "01", place / "01")
    return place


def change(path, **values):
    form = json.loads(path.read_text())
    path.write_text(json.dumps({**form, **values}))


def test_what_describes_the_rig_needs_a_reason_to_differ(one):
    change(one / "01" / "run.json", M={"value": 3.9, "u": 0.002})
    with pytest.raises(RigError, match=r"M is 3\.9 \+- 0\.002, but .*rig\.json says 3\.8.*write why") as caught:
        read_folder(one / "01")
    assert "\n" not in str(caught.value)
    change(one / "01" / "run.json", overrule={"M": "weighed again"})
    found = read_run(one / "01")
    assert found.recording.run.M.value == 3.9
    assert run_row(found)["overruled"].endswith("3.9 +- 0.002 is taken: weighed again")
    (one / "01" / "channels.tsv").write_text("name\tsensitivity\nlo_acc\t98.5\n")
    with pytest.raises(RigError, match=r'but the campaign.* says 100\.0 for lo_acc; write why.*"lo_acc\.sensitivity"'):
        read_folder(one / "01")
    change(one / "01" / "run.json", overrule={"M": "weighed again", "lo_acc.sensitivity": "another sensor"})
    found = read_run(one / "01")
    assert found.rows["lo_acc"].sensitivity == 98.5
    rows = {row["channel"]: row["overruled"] for row in channel_rows(found)}
    assert rows["lo_acc"] == "sensitivity: the campaign says 100.0, 98.5 is taken: another sensor"
    assert rows["lo_disp"] == ""


def test_what_was_done_in_a_run_needs_none(one):
    change(one / "01" / "run.json", settle=7.0, protocol="dwell", temperature_after=20.5)
    assert read_folder(one / "01").form.settle == 7.0
    shared = json.loads((one / "rig.json").read_text())
    (one / "rig.json").write_text(json.dumps({**shared, "temperature_before": 19.0}))
    assert read_folder(one / "01").form.temperature_before == 20.0


def test_a_recording_cannot_confirm_the_command_that_was_read_from_it(one):
    shared = json.loads((one / "rig.json").read_text())
    assert "base_disp against the command" in read_run(one / "01").compared
    (one / "rig.json").write_text(json.dumps({**shared, "f_cmd": None}))
    found = read_run(one / "01")
    assert found.recording.run.f_cmd == pytest.approx(FORCED.f, rel=1e-4)
    assert "base_disp against the command (E_cmd alone)" in found.compared
    change(one / "01" / "run.json", f_cmd=9.5)  # what a person types in its place is a command again
    with pytest.raises(RigError, match=r"f_cmd is 9\.5 Hz"):
        read_run(one / "01")


@pytest.mark.parametrize(
    ("edit", "reason"),
    [
        (lambda one: change(one / "rig.json", run_id="all"), "run_id is a run's own"),
        (lambda one: change(one / "rig.json", setle=1.0), "did you mean 'settle'"),
        (lambda one: change(one / "rig.json", settle="long"), r"rig\.json: Expected `float \| null`, got `str`"),
        (lambda one: change(one / "rig.json", M={"value": None, "u": None}), "stated neither there nor in .*: M"),
        (lambda one: (one / "rig.json").write_text("{"), "rig.json is not JSON"),
        (lambda one: (one / "01" / "raw" / "more.tdms").touch(), r"2 files fit '\*\.tdms'.*01\.tdms, more\.tdms"),
        (lambda one: (one / "01" / "raw" / "01.tdms").rename(one / "01" / "raw" / "01.x"), "no file fits .*01.x"),
        (lambda one: (one / "01" / "channels.tsv").write_text("name\tsensor\nlo\tnew\n"), "no role"),
    ],
)
def test_refused_in_one_line(one, edit, reason):
    edit(one)
    with pytest.raises((RigError, FileNotFoundError), match=reason) as caught:
        read_folder(one / "01")
    assert "\n" not in str(caught.value)


def test_a_run_more_is_begun_from_its_recording(one, laboratory, tmp_path):
    """The campaign being described, a recording gives the amplitude of its base too."""
    made = init_run(one / "08", [laboratory / "recordings" / "02.tdms"])
    form = json.loads((one / "08" / "run.json").read_text())
    assert form["E_cmd"] == pytest.approx(FORCED.E, rel=0.02)
    assert (form["f_cmd"], form["protocol"]) == (pytest.approx(FORCED.f, rel=1e-4), "dwell")
    assert made.todo == {one / "08" / "run.json": 2}
    assert not (one / "08" / "channels.tsv").exists()
    change(one / "08" / "run.json", temperature_before=20.0, temperature_after=20.0)
    assert read_run(one / "08").compared[0] == "base_disp against the command (f_cmd alone)"
    with pytest.raises(StoreError, match="exists already"):
        init_run(one / "08")


def test_a_run_like_another_says_what_is_new(one, laboratory, tmp_path):
    recording = laboratory / "recordings" / "03.tdms"
    made = init_run(tmp_path / "alone", [recording], laboratory / "runs" / "forced")
    assert made.todo == {tmp_path / "alone" / "run.json": 2}
    change(tmp_path / "alone" / "run.json", temperature_before=20.0, temperature_after=20.0)
    found, wanted = read_run(tmp_path / "alone"), read_run(laboratory / "runs" / "forced")
    assert isinstance(found, Ingested)
    for name, channel in wanted.recording.channels.items():
        assert np.array_equal(channel.values, found.recording.channels[name].values)
    assert found.recording.run.more["friction"] == wanted.recording.run.more["friction"]
    assert "proposed by synthetic, which it is like: " in run_row(found)["came_from"]
    change(one / "01" / "run.json", more={"tilt": {"value": 0.001, "u": 0.01}})
    init_run(one / "09", [recording], one / "01")
    told = json.loads((one / "09" / "run.json").read_text())
    assert told["protocol"] == "sweep_up"
    assert "M" not in told


def test_a_recording_says_what_it_knows_and_no_more(tmp_path):
    (tmp_path / "log.csv").write_text(
        "Time [ms];Base acceleration [m/s²];lo laser [V];ai3 [V]\n"
        + "\n".join(f"{k};{np.sin(k / 20):.5f};{np.cos(k / 20):.5f};0.1" for k in range(3000)).replace(".", ",")
        + "\n"
    )
    made = init_run(tmp_path / "new", [tmp_path / "log.csv"])
    head, *rows = [line.split("\t") for line in made.files[1].read_text().splitlines() if line[0] != "#"]
    cells = {row[0]: dict(zip(head, row, strict=True)) for row in rows}
    assert [cells[name]["role"] for name in cells] == ["base_acc", "lo_disp", "n/a"]
    assert cells["Base_acceleration"]["sensitivity"] == "scaled"
    assert cells["lo_laser"]["sensitivity"] == "n/a"
    assert "decimal=comma" in cells["lo_laser"]["dialect"]
    form = json.loads(made.files[0].read_text())
    assert form["f_cmd"] == pytest.approx(50 / (2 * np.pi), rel=1e-3)
    assert form["start_utc"] is None
    assert form["M"] == {"value": None, "u": None}
    assert any("1000 Hz" in remark for remark in made.remarks)
    for name in ("start_utc", "E_cmd", "settle", "temperature_after"):
        with pytest.raises(RigError, match=f"still null: .*{name}"):
            read_folder(tmp_path / "new")


def test_a_scale_in_the_head_is_proposed_and_not_applied(tmp_path):
    counts = np.rint(20000 * np.sin(np.arange(600) / 20)).astype(int)
    text = "Time,lo laser\nms,V\nScale,0.0003\n" + "".join(f"{k},{value}\n" for k, value in enumerate(counts))
    (tmp_path / "log.csv").write_text(text)
    made = init_run(tmp_path / "new", [tmp_path / "log.csv"])
    head, row = [line.split("\t") for line in made.files[1].read_text().splitlines() if line[0] != "#"]
    cells = dict(zip(head, row, strict=True))
    assert (cells["scale"], cells["unit"], cells["sensitivity"]) == ("0.0003", "V", "n/a")
    proposed = json.loads(made.files[0].read_text())["proposed"]
    assert proposed["lo_laser.scale"]["by"] == "recording log.csv, scale in the file"
