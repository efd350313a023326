"""The rehearsal of a campaign, coarse: raw TDMS of two runs of ten seconds, through to the tables and commands."""

import json
import shutil
from pathlib import Path

import pytest

from tests.made_once import own_copy
from tests.project import Project
from vines.errors import VinesError
from vines.rig import load_reconstruction, save_reconstruction
from vines.stages import reconstruct_run

pytestmark = [pytest.mark.long(35), pytest.mark.usefixtures("coarse_look")]

PIPELINES = Path(__file__).parents[2] / "pipelines"
COARSE = {
    "campaign.amplitudes": "[0.015]",
    "campaign.settings.duration": "10.0",
    "campaign.settings.settle": "12.0",
    "one_to_one.points": "12",
    "one_to_one.switch": "0",
    "two_to_one.points": "6",
    "two_to_one.seeds": "3",
}


@pytest.fixture(scope="module")
def rehearsed(tmp_path_factory):
    """Return a project in which the coarse rehearsal has been run; not to be changed."""
    root = tmp_path_factory.mktemp("rehearsal")
    (root / "pipelines").mkdir()
    shutil.copy(PIPELINES / "rehearsal.toml", root / "pipelines")
    project = Project(root)
    project.settings = [f"--set=stages.{key}={value}" for key, value in COARSE.items()]
    project.vines("run", "rehearsal", *project.settings)
    return project


@pytest.fixture
def campaign(rehearsed, tmp_path):
    """Return a copy of the campaign's run folders."""
    (made,) = rehearsed.data.glob("results/*/sealed")
    shutil.copytree(made.parent / "runs", tmp_path / "runs")
    return tmp_path / "runs"


def rows(project, sql):
    return json.loads(project.vines("query", sql, "--format", "json").stdout)


def test_each_run_is_a_row_with_uncertainties_and_its_ring_downs(rehearsed):
    up, down = rows(rehearsed, "select * from reconstructions order by run_id")
    assert (up["run_id"], up["protocol"], up["ringdown"]) == ("01_up", "sweep_up", "00_ringdown 02_ringdown")
    assert (down["run_id"], down["protocol"], down["ringdown"]) == ("03_down", "sweep_down", "02_ringdown 04_ringdown")
    for row in (up, down):
        assert row["status"] == "ok"
        assert row["accepted"], row["findings"]
        assert (row["pattern"], row["n"], row["m"], row["p"]) == ("1:1", 1, 1, 1)
        assert row["word"] in ("LR", "RL")
        # r falls as speed^-.08 from .65 at .5 m/s; the shaker sags by 4 %
        assert row["r"] == pytest.approx(0.65 * (row["w_before"] / 0.5) ** -0.08, abs=0.005)
        assert row["A"] == pytest.approx(0.96 * 0.015, abs=4 * row["u_A"])
        assert row["mu"] == pytest.approx(0.032 / 3.807, abs=4 * row["u_mu"])
        assert 0 < row["u_r"] < 0.005


def test_impacts_are_rows_of_their_own(rehearsed):
    counts = rows(
        rehearsed,
        "select i.run_id, count(*) as impacts, any_value(r.impacts) as told from rig_impacts i "
        "join reconstructions r using (run_id) group by i.run_id",
    )
    assert len(counts) == 2
    assert all(row["impacts"] == row["told"] > 150 for row in counts)
    (mean,) = rows(rehearsed, "select avg(r) as r from rig_impacts where run_id = '01_up' and not suspect")
    (told,) = rows(rehearsed, "select r from reconstructions where run_id = '01_up'")
    assert mean["r"] == pytest.approx(told["r"], abs=1e-3)


def test_verify_understands_the_tables(rehearsed):
    said = rehearsed.vines("verify", "rehearsal").stdout
    assert "|measured - model|/(2 sqrt(u^2 + u_model^2))" in said
    assert "all hold" in said
    assert "A = E/b" in said
    assert "r = -w_dot_after/w_dot" in said


def test_tampered_rows_are_seen(rehearsed):
    import numpy as np
    import pyarrow as pa
    import pyarrow.parquet as pq

    from vines.stages.audit._rig import reconstruction_defects, rig_impact_defects
    from vines.stages.audit._rows import Rows

    def broken(table, checks, column, change, row=1):
        (path,) = rehearsed.data.glob(f"results/*/{table}.parquet")
        good = pq.read_table(path)
        values = good.column(column).to_pylist()
        values[row] = change(values[row])
        place = good.column_names.index(column)
        bad = good.set_column(place, column, pa.array(values, type=good.schema.field(column).type))
        return [defect.name for defect in checks(Rows(bad)) if np.nanmax(defect.values) > defect.allowed]

    assert broken("reconstructions", reconstruction_defects, "A", lambda a: 1.001 * a) == ["amplitude"]
    assert broken("reconstructions", reconstruction_defects, "omega0", lambda a: 1.001 * a) == ["frequency ratio"]
    assert broken("reconstructions", reconstruction_defects, "fraction", lambda a: 0.9 * a) == ["pattern"]
    assert broken("reconstructions", reconstruction_defects, "word", lambda a: a + "L") == ["word"]
    assert broken("reconstructions", reconstruction_defects, "accepted", lambda a: not a) == ["gates"]
    assert broken("rig_impacts", rig_impact_defects, "side", lambda a: -a) == ["walls"]
    assert broken("rig_impacts", rig_impact_defects, "r", lambda a: a + 0.01) == ["restitution"]
    assert broken("rig_impacts", rig_impact_defects, "t", lambda a: a + 1.0) == ["order", "flights"]
    assert broken("rig_impacts", rig_impact_defects, "v2_after", lambda a: a + 0.01) == ["relative velocity", "flights"]


def test_every_run_has_a_verdict_with_its_reason(rehearsed):
    found = rows(rehearsed, "select * from comparisons where rank = 0 order by run_id")
    assert [(row["run_id"], row["basis"]) for row in found] == [("01_up", "measured"), ("03_down", "measured")]
    for row in found:
        assert row["verdict"] == "agree", row["reason"]
        assert (row["branch"], row["word"], row["regime"], row["mirrored"]) == ("1:1", "LR", "periodic", False)
        assert max(row["E_n_phase"], row["E_n_max_abs_x1"], row["E_n_kinetic_ratio"]) <= 1
        assert row["holding"] > 0.95
        assert row["rms_w"] < 0.05
        assert row["rms_w_dot"] < 0.15
        assert row["calibrated_on"] is None  # two runs are too few to calibrate on


def test_cycles_and_waits_of_run_and_model(rehearsed):
    import numpy as np

    (row,) = rows(rehearsed, "select * from rig_cycles where run_id = '01_up' and rank = 0")
    assert len(row["time"]) == len(row["w"]) == len(row["model_w_dot"])
    assert np.abs(row["w"]).max() <= 1.001
    assert sum(row["wait_share"]) > 0.99
    middle = np.convolve(row["wait_edges"], [0.5, 0.5], "valid")
    assert np.dot(middle, row["wait_share"]) == pytest.approx(0.5, abs=0.01)  # 1:1: half a period from wall to wall
    assert np.dot(middle, row["model_wait_share"]) == pytest.approx(0.5, abs=0.01)


def test_measured_and_modelled_run_have_one_clock(rehearsed):
    import numpy as np

    from vines import logs

    (folder,) = {path.parent for path in rehearsed.data.glob("results/*/01_up.measured.mcap")}
    measured, model = (logs.read(folder / f"01_up.{what}.mcap") for what in ("measured", "model"))
    assert measured.parameters == model.parameters
    w = {}
    for log in (measured, model):
        t, phase = log.states["t"].to_numpy(), log.states["phase"].to_numpy()
        assert np.allclose(np.exp(1j * (phase - log.parameters["Omega"] * t)), 1.0, atol=1e-6)
        w[log.path.name] = np.interp(np.linspace(10.0, 60.0, 2000), t, log.states["w"].to_numpy())
    one, other = w.values()
    assert np.sqrt(np.mean((one - other) ** 2)) < 0.1 * np.sqrt(np.mean(other**2))
    listed = rehearsed.vines("view", "rehearsal.compare/01_up", "--overlay", "--save", rehearsed.root / "o.rrd")
    assert "wrote" in listed.stdout


def test_the_figures_are_drawn_and_the_report_tells_the_verdicts(rehearsed, tmp_path):
    drawn = list(rehearsed.data.glob("results/*/picture.svg"))
    assert len(drawn) == 5
    rehearsed.vines("report", "rehearsal", "--out", tmp_path / "rehearsal.html")
    text = (tmp_path / "rehearsal.html").read_text("utf-8")
    assert "Rig beside the model, measured parameters: 2 agree" in text
    assert text.count("<figure>") == 5
    assert "vines view rehearsal.compare/01_up/model" in text


def test_compare_by_hand_gives_the_verdict_and_writes_derived(rehearsed, campaign):
    shown = rehearsed.process("rig", "compare", campaign / "01_up").stdout
    assert shown.startswith("01_up: agree\n1:1: E_n(phase)")
    said = json.loads((campaign / "01_up" / "derived" / "comparison.json").read_text())
    (row,) = rows(rehearsed, "select * from comparisons where run_id = '01_up' and rank = 0")
    assert said[0]["verdict"] == row["verdict"] == "agree"
    assert said[0]["E_n_phase"] == pytest.approx(row["E_n_phase"])


def test_a_declaration_that_cannot_compare_is_refused_before_anything_runs(project):
    form = 'title = "t"\n[stages.a]\nkind = "ingest"\nfolder = "runs"\n'
    for more, words in (
        ('[stages.b]\nkind = "reconstruct"\n', "name a stage of kind ingest in needs"),
        ('[stages.b]\nkind = "compare"\nneeds = ["a"]\n', "a has neither, remove it from needs"),
        ('[stages.b]\nkind = "figure"\nplot = "rig_cycles"\nneeds = ["a"]\n', "needs a stage of kind compare"),
    ):
        (project.root / "pipelines" / "mine.toml").write_text(form + more)
        done = project.vines("status", "mine", check=False)
        assert done.returncode == 2
        assert words in done.stderr
        assert done.stderr.count("\n") == 1


def test_an_interrupted_campaign_goes_on_with_what_was_reconstructed(rehearsed, tmp_path):
    settings, rehearsed = rehearsed.settings, Project(own_copy(rehearsed.root, tmp_path))
    kept = sorted(rehearsed.data.glob("cache/rig/*.npz"))
    assert len(kept) == 2
    before = [path.stat().st_mtime_ns for path in kept]
    (table,) = rehearsed.data.glob("results/*/reconstructions.parquet")
    bytes_before = table.read_bytes()
    rehearsed.vines("run", "rehearsal", "reconstruct", "--force", "--jobs", "2", *settings)
    assert [path.stat().st_mtime_ns for path in kept] == before
    assert table.read_bytes() == bytes_before


def test_a_reconstruction_is_the_same_after_it_was_kept(rehearsed, tmp_path):
    import numpy as np

    (path,) = rehearsed.data.glob("results/*/reconstructions/01_up.npz")
    found = load_reconstruction(path)
    save_reconstruction(found, tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == path.read_bytes()
    t = np.linspace(1.0, 2.0, 50)
    assert np.array_equal(found.track.w(t), load_reconstruction(tmp_path / "again.npz").track.w(t))


def test_reconstruct_by_hand_gives_the_row_and_writes_derived(rehearsed, campaign):
    rehearsed.process("rig", "reconstruct", campaign / "01_up")
    said = json.loads((campaign / "01_up" / "derived" / "reconstruction.json").read_text())
    (row,) = rows(rehearsed, "select * from reconstructions where run_id = '01_up'")
    assert said == {name: row[name] for name in said}
    derived = campaign / "01_up" / "derived"
    assert (derived / "rig_impacts.parquet").is_file()
    shown = rehearsed.vines("rig", "reconstruct", campaign / "01_up", "--ringdown", campaign / "00_ringdown").stdout
    assert "omega0 and lam by 00_ringdown\n" in shown
    assert "Coefficient of restitution" in shown


def test_reconstruct_refuses_in_one_line(campaign, tmp_path, monkeypatch):
    monkeypatch.setenv("VINES_DATA", str(tmp_path / "data"))

    def refused(*arguments):
        with pytest.raises(VinesError) as caught:
            reconstruct_run(*arguments)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    assert "it gives omega0 and lam of the runs that name it" in refused(campaign / "00_ringdown")
    assert "name one of them" in refused(campaign)
    assert "allowed for --ringdown is ringdown" in refused(campaign / "01_up", [campaign / "03_down"])
    shutil.rmtree(campaign / "02_ringdown")
    assert "names the ring-down '02_ringdown', which is not at hand" in refused(campaign / "01_up")
    assert "there is no run.json" in refused(campaign.parent / "nowhere")
    kept = shutil.copytree(campaign / "01_up", tmp_path / "data" / "results" / "a" / "01_up")
    assert "is a stored result, which is never changed" in refused(kept)
    assert not (campaign / "01_up" / "derived").exists() or not list((campaign / "01_up" / "derived").iterdir())
