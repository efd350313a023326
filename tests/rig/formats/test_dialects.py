"""Random tables in random dialects: read back equal, or refused with a reason; no column is taken for another."""

import numpy as np
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from vines.errors import RigError
from vines.rig.formats import read_file
from vines.rig.formats._csv._dialect import SEPARATORS

UNITS = ("V", "mV", "m/s²", "g", "µm", "Volts")
HEADS = ("{name} [{unit}]", "{name} ({unit})", "{name}/{unit}", "{name}, {unit}", "row", "none", "bare")
NOISE = ("", "\n", "# a note\n", "Recorded by the laboratory\n", "Serial number: 1234\nSample rate: 2000 Hz\n")
NUMBERS = st.floats(-1e3, 1e3).map(lambda value: round(value, 4))


@st.composite
def files(draw):
    """Return the bytes of a file and the table that it holds."""
    columns = draw(st.integers(1, 5))
    count = draw(st.integers(2, 40))
    values = np.array(
        draw(st.lists(st.lists(NUMBERS, min_size=columns, max_size=columns), min_size=count, max_size=count))
    )
    units = draw(st.lists(st.sampled_from(UNITS), min_size=columns, max_size=columns))
    separator = SEPARATORS[draw(st.sampled_from(["comma", "semicolon", "tab", "bar", "space"]))]
    decimal = draw(st.sampled_from([".", ","]))
    form = draw(st.sampled_from(["{:.4f}", "{:g}", "{:+.6e}", "{:12.5f}", "{:.0f}"]))
    quote = draw(st.booleans()) if separator != " " else False
    head = draw(st.sampled_from(HEADS))
    timed = draw(st.sampled_from(["s", "ms", "", "none"]))
    trailing = separator if separator != " " and draw(st.booleans()) else ""
    times = np.arange(count) * 0.5
    cells = [[form.format(value).replace(".", decimal) for value in row] for row in values]
    names = [(f"ch{k}", unit) for k, unit in enumerate(units)]
    if timed != "none":
        names.insert(0, ("Time", timed))
        for time, row in zip(times * (1e3 if timed == "ms" else 1), cells, strict=True):
            row.insert(0, f"{time:.6f}".replace(".", decimal))
    if quote:
        cells = [[f'"{cell}"' for cell in row] for row in cells]
    text = draw(st.sampled_from(NOISE))
    if head == "row":
        text += separator.join(name for name, _ in names) + "\n"
        text += separator.join(f"({unit})" if unit else "()" for _, unit in names) + "\n"
    elif head == "bare":
        text += separator.join(name for name, _ in names) + "\n"
    elif head != "none":
        told = [head.format(name=name, unit=unit) if unit else name for name, unit in names]
        if separator == "," and ", " in head:
            told = [f'"{one}"' for one in told]
        text += (separator * (2 if separator == " " else 1)).join(told) + "\n"
    text += "".join(separator.join(row) + trailing + "\n" for row in cells)
    encoding = draw(st.sampled_from(["utf-8", "utf-8-sig", "cp1252", "utf-16"]))
    end = draw(st.sampled_from(["\n", "\r\n"]))
    written = np.array([[float(form.format(value)) for value in row] for row in values])
    said = [None if head in ("none", "bare") else unit for unit in units]
    return text.replace("\n", end).encode(encoding), written, timed, said


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(made=files())
@example(made=(b"t [s],lo [V]\n0,1,\n1,2,\n", np.array([[1.0], [2.0]]), "s", ["V"]))
@example(made=(b"ch0 [V]\n+0,000000e+00,\n+0,000000e+00,\n", np.array([[0.0], [0.0]]), "none", ["V"]))
def test_a_table_is_read_as_it_was_written_or_refused(tmp_path, made):
    data, values, timed, units = made
    path = tmp_path / "a.csv"
    path.write_bytes(data)
    try:
        found = read_file(path)
    except RigError as refused:
        said = str(refused)
    else:
        said = ""
        columns = [np.asarray(each.values) for each in found.channels]
        if len(columns) == values.shape[1] + 1:
            # Without a head a column of times is one like the others.
            assert timed != "none"
            columns = columns[1:]
        else:
            assert [each.unit for each in found.channels] == units
        assert len(columns) == values.shape[1]
        for column, wanted in zip(columns, values.T, strict=True):
            np.testing.assert_array_equal(column, wanted)
    assert "\n" not in said
    assert not said or said.startswith("a.csv")


def test_most_are_read(tmp_path):
    """A reader that refuses everything would pass the test above."""
    read = []

    @settings(max_examples=60, deadline=None, database=None, derandomize=True)
    @given(made=files())
    def tried(made):
        (tmp_path / "a.csv").write_bytes(made[0])
        try:
            read_file(tmp_path / "a.csv")
        except RigError as refused:
            read.append(str(refused))
        else:
            read.append("")

    tried()
    assert read.count("") > 0.7 * len(read), sorted(set(read))
