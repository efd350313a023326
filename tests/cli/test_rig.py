"""``vines rig``: its commands list themselves, make and inspect run folders, and refuse in one line."""

import json

import matplotlib.image
import pytest
from click.testing import CliRunner

from tests.project import Project
from vines.cli._rig import command
from vines.errors import VinesError

LIGHT = ("--set", "duration=2", "--set", "settle=1", "--set", "rate=12800")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a project with a synthetic run."""
    project = Project(tmp_path_factory.mktemp("rig"))
    project.said = project.process("rig", "synth", "demo/run_1", "--seed", 3, *LIGHT).stdout
    return project


def test_help_lists_every_command(made):
    said = made.vines("rig", "--help").stdout
    listed = [line.split()[0] for line in said.partition("Commands:")[2].splitlines() if line.startswith("  ")]
    wanted = ["init", "inspect", "ingest", "reconstruct", "compare", "synth", "campaign"]
    assert [name for name in listed if name in wanted] == wanted


def test_synth_makes_a_run_folder_and_seals_its_truth(made):
    folder = made.root / "demo" / "run_1"
    assert made.said.startswith("wrote demo/run_1 (raw/run.tdms): 2 s at 12800 Hz")
    assert {path.name for path in folder.iterdir()} >= {"run.json", "channels.tsv", "raw"}
    sealed = json.loads((made.root / "demo" / "sealed" / "run_1.json").read_text())
    assert sealed["settings"]["duration"] == 2.0
    assert "r" not in json.loads((folder / "run.json").read_text())


def test_inspect_shows_and_draws_what_a_raw_file_holds(made):
    raw = made.root / "demo" / "run_1" / "raw" / "run.tdms"
    told = json.loads(made.process("rig", "inspect", raw, "--json", "--png", made.root / "raw.png").stdout)
    assert told["form"] == "NI TDMS"
    assert [each["name"].rpartition("/")[2] for each in told["channels"]] == [
        "base_disp",
        "base_acc",
        "lo_disp",
        "lo_acc",
    ]
    assert {each["samples"] for each in told["channels"]} == {25600}
    assert {each["unit"] for each in told["channels"]} == {"V"}
    assert matplotlib.image.imread(made.root / "raw.png").std() > 0.05


def test_campaign_makes_a_sweep_up_and_down_between_ring_downs(made):
    said = made.process("rig", "campaign", "sweep", "--count", 1, *LIGHT).stdout
    assert said.startswith("wrote 5 runs")
    runs = sorted(path.name for path in (made.root / "sweep" / "runs").iterdir())
    assert runs == ["00_ringdown", "01_up", "02_ringdown", "03_down", "04_ringdown"]
    told = json.loads((made.root / "sweep" / "runs" / "01_up" / "run.json").read_text())
    assert (told["protocol"], told["ringdown"]) == ("sweep_up", ["00_ringdown", "02_ringdown"])


def test_wrong_use_is_one_line(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for arguments, words in (
        (["synth", "run_2", "--set", "duratoin=2"], "did you mean 'duration'"),
        (["synth", "run_2", "--set", "duration"], "is not of the form key=value"),
        (["campaign", "other", "--from", "0.02", "--to", "0.01"], "allowed are 0 < from < to"),
        (["inspect", str(made.root / "demo" / "run_1" / "run.json")], "run.json"),
    ):
        said = CliRunner().invoke(command, arguments).exception
        assert isinstance(said, VinesError)
        assert words in str(said)
        assert "\n" not in str(said)
    assert list(tmp_path.iterdir()) == []
