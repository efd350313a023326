"""Run folders: what is written is read, what is not filled in or wrong is one line."""

import json

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vines.errors import FileMissingError, RigError
from vines.rig import ROLES, find_runs, init_run, read_folder
from vines.rig.ingest import channels_text
from vines.rig.ingest._run_form import ChannelRow, RunForm, Stated

NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,12}", fullmatch=True)
WORDS = st.text("abc µ°/(%)é", max_size=8).map(str.strip)
SIZES = st.floats(1e-6, 1e6)
STATED = st.builds(Stated, value=SIZES, u=st.floats(0, 1))
FORMS = st.builds(
    RunForm,
    run_id=NAMES,
    start_utc=st.just("2026-03-01T10:00:00.25Z"),
    protocol=st.sampled_from(["dwell", "sweep_up", "sweep_down", "ringdown"]),
    f_cmd=SIZES,
    E_cmd=SIZES,
    settle=st.floats(0, 1e4),
    M=STATED,
    m=STATED,
    b=STATED,
    ball=st.booleans(),
    temperature_before=st.floats(-50, 150),
    temperature_after=st.floats(-50, 150),
    ringdown=st.lists(NAMES, max_size=2).map(tuple),
    E_meas=st.none() | STATED,
    materials=st.dictionaries(NAMES, WORDS, max_size=2),
    more=st.dictionaries(NAMES.filter(lambda name: name not in ("friction", "tilt")), SIZES | WORDS, max_size=2),
)
ROWS = st.lists(
    st.builds(
        ChannelRow,
        name=NAMES,
        role=st.sampled_from(list(ROLES)),
        quantity=st.just("displacement"),
        dof=st.just("x1"),
        file=st.just("a.tdms"),
        field=NAMES,
        unit=st.sampled_from(["V", "mV", "m/s^2"]),
        sensitivity=SIZES | st.just("scaled"),
        sensitivity_unit=st.sampled_from(["mV/g", "V/mm"]),
        u_sensitivity=st.floats(0, 0.5),
        sign=st.sampled_from(["+1", "-1"]),
        fs=SIZES | st.just("file"),
        t0=st.floats(-1, 1) | st.just("file"),
        range=SIZES,
        group_delay=st.floats(0, 1),
        bits=st.none() | st.integers(8, 32),
        sensor=WORDS,
        scale=SIZES,
        offset=st.floats(-1, 1),
        dialect=st.sampled_from(["", "separator=comma time_unit=ms"]),
        overrule=st.sampled_from(["", "unit: a slip; fs: wf_increment is 1"]),
    ).map(lambda row: msgspec.structs.replace(row, quantity=ROLES[row.role][0])),
    min_size=1,
    max_size=4,
    unique_by=lambda row: row.name,
)


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(form=FORMS, rows=ROWS, comment=WORDS)
def test_what_is_written_is_read(tmp_path, form, rows, comment):
    (tmp_path / "raw").mkdir(exist_ok=True)
    (tmp_path / "raw" / "a.tdms").touch()
    told = {"_note": comment, **msgspec.to_builtins(form)}
    (tmp_path / "run.json").write_text(json.dumps(told), encoding="utf-8")
    (tmp_path / "channels.tsv").write_text(f"# {comment}\n" + channels_text(rows), encoding="utf-8")
    found = read_folder(tmp_path)
    assert found.form == form
    assert found.rows == tuple(rows)
    assert found.raw_files == (tmp_path / "raw" / "a.tdms",)
    assert found.info.M.value == form.M.value


def test_a_template_that_is_not_filled_in_lists_what_is_null(tmp_path):
    init_run(tmp_path / "new")
    with pytest.raises(RigError) as caught:
        read_folder(tmp_path / "new")
    said = str(caught.value)
    assert "still null: f_cmd (null for protocol ringdown only), E_cmd" in said
    assert "settle, M.value, M.u, m.value" in said
    assert "\n" not in said
    told = json.loads((tmp_path / "new" / "run.json").read_text())
    assert all(text for key, text in told.items() if key.startswith("_"))


def test_friction_and_tilt_are_numbers_with_uncertainties_or_null(short_run, tmp_path):
    folder, _ = short_run
    form = json.loads((folder / "run.json").read_text())
    (tmp_path / "channels.tsv").write_text((folder / "channels.tsv").read_text())
    (tmp_path / "raw").symlink_to(folder / "raw")

    def read(**more):
        (tmp_path / "run.json").write_text(json.dumps({**form, "more": more}))
        return read_folder(tmp_path).info.more

    assert "friction" not in read(friction={"value": None, "u": None}, tilt=None)
    assert read(friction={"value": 0.06, "u": 0.01})["friction"] == {"value": 0.06, "u": 0.01}
    for wrong in (0.06, {"value": 0.06}, {"value": "0.06", "u": 0.01}, {"value": 0.06, "u": -1}):
        with pytest.raises(RigError, match=r"more\.friction: .*allowed is \{\"value\"") as caught:
            read(friction=wrong)
        assert "\n" not in str(caught.value)


def test_what_cannot_be_read_says_where(tmp_path):
    with pytest.raises(FileMissingError, match="no run folder and none in it"):
        find_runs(tmp_path)
    (tmp_path / "run.json").write_text('{"run_id": ')
    (tmp_path / "channels.tsv").write_text("name,role\nlo,lo_disp\n")
    with pytest.raises(RigError, match=r"run\.json is not JSON: "):
        read_folder(tmp_path)
    (tmp_path / "run.json").write_text("[1]")
    with pytest.raises(RigError, match="is not an object"):
        read_folder(tmp_path)
