"""A damaged log is salvaged or refused: what was saved is exactly what was written, what was lost is said."""

import numpy as np
import pytest
from mcap.writer import CompressionType, Writer

from vines import logs
from vines.errors import FileMissingError, LogError

pytestmark = pytest.mark.long(12)

TIMES = {"states": "t", "impacts": "t", "sticks": "t_start"}


@pytest.fixture(scope="module")
def whole(run, tmp_path_factory):
    """Return a log with the profile for bare viewers, its bytes, and its arrays."""
    return logs.write_run(tmp_path_factory.mktemp("whole") / "run.mcap", **{**run, "bare": True})


def is_part(table, rows, time):
    """Assert that the rows of a table are rows that were written, in their order; return how many."""
    times = table[time].to_numpy()
    places = np.searchsorted(rows[time], times)
    assert (np.diff(places) > 0).all()
    for name in rows.dtype.names:
        np.testing.assert_array_equal(table[name].to_numpy(), rows[name][places])
    return len(times)


def salvaged(whole, run, data, path):
    """Recover damaged bytes; return the log and what was said, or None if it was refused in one clear line."""
    path.write_bytes(data)
    out = path.with_suffix(".out.mcap")
    out.unlink(missing_ok=True)
    with pytest.raises(LogError):
        logs.read(path)
    said, refused = None, ""
    try:
        said = logs.recover(path, out)
    except LogError as error:
        refused = str(error)
    if said is None:
        assert "\n" not in refused
        assert "nothing can be recovered" in refused
        assert not out.exists()
        return None
    assert path.read_bytes() == data
    log = logs.read(out)
    assert log.status == "recovered"
    assert not log.complete
    saved = {key: is_part(getattr(log, key), run[key], time) for key, time in TIMES.items()}
    if saved != {key: len(run[key]) for key in TIMES}:
        assert said.lost
    # Nothing of the description is passed on unless it is what was written.
    before = logs.read(whole)
    assert log.provenance == before.provenance or "damaged" in log.provenance["remark"]
    assert log.parameters in (before.parameters, {})
    assert log.declaration in (before.declaration, None)
    if log.declaration is None:
        assert any("declaration.toml" in line for line in said.lost) or len(said.lost) > 0
    return log, said, saved


def test_cut_at_fifty_places(whole, run, tmp_path):
    data = whole.read_bytes()
    outcomes = []
    for cut in np.sort(np.random.default_rng(50).integers(1, len(data), 50)).tolist():
        outcome = salvaged(whole, run, data[:cut], tmp_path / "cut.mcap")
        outcomes.append(-1 if outcome is None else outcome[2]["states"])
    assert outcomes == sorted(outcomes)
    assert outcomes[0] == -1
    assert outcomes[-1] > 2000
    assert sum(count > 0 for count in outcomes) > 30


def test_fifty_flipped_bits(whole, run, tmp_path):
    data = whole.read_bytes()
    random = np.random.default_rng(51)
    refused = 0
    for place in random.integers(0, len(data), 50).tolist():
        flipped = bytearray(data)
        flipped[place] ^= 1 << int(random.integers(0, 8))
        outcome = salvaged(whole, run, bytes(flipped), tmp_path / "flipped.mcap")
        if outcome is None:
            refused += 1
            continue
        # One byte costs one chunk at most.
        assert outcome[2]["states"] > 1500
    assert refused == 0


@pytest.mark.parametrize("each", [pytest.param(1, marks=pytest.mark.full), 5])
def test_every_byte_of_the_head_and_the_end(whole, run, tmp_path, each):
    data = whole.read_bytes()
    first_chunk = data.index(b"zstd") - 37
    random = np.random.default_rng(52)
    places = [*random.integers(0, first_chunk, 60).tolist(), *range(len(data) - 40, len(data))]
    for place in [*range(0, 12), *places][::each]:
        flipped = bytearray(data)
        flipped[place] ^= 0xFF
        outcome = salvaged(whole, run, bytes(flipped), tmp_path / "head.mcap")
        assert outcome is not None, place
        assert outcome[2] == {key: len(run[key]) for key in TIMES}, (place, outcome[1])


def test_what_is_said(whole, run, tmp_path):
    data = whole.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) // 2])
    said = logs.recover(cut)
    assert said.path == tmp_path / "cut.recovered.mcap"
    log = logs.read(said.path)
    assert any(line.startswith(f"/state: {log.states.num_rows} messages, t ") for line in said.saved)
    assert any("how many messages followed is not known" in line for line in said.lost)
    assert log.recovered["lost"] == "\n".join(said.lost)
    assert log.recovered["from"] == "cut.mcap"

    middle = data.index(b"zstd") + 2000
    flipped = bytearray(data)
    flipped[middle] ^= 1
    hurt = tmp_path / "hurt.mcap"
    hurt.write_bytes(flipped)
    said = logs.recover(hurt)
    rest = logs.read(said.path).states.num_rows
    assert f"/state: {len(run['states']) - rest} of {len(run['states'])} messages" in said.lost
    assert any("a chunk of messages" in line and line.startswith("bytes ") for line in said.lost)


def test_nothing_is_overwritten_and_intact_logs_are_left_alone(whole, tmp_path):
    with pytest.raises(LogError, match="is intact"):
        logs.recover(whole, tmp_path / "out.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[:-50])
    (tmp_path / "cut.recovered.mcap").write_bytes(b"mine")
    with pytest.raises(LogError, match="exists and is not overwritten"):
        logs.recover(cut)
    assert (tmp_path / "cut.recovered.mcap").read_bytes() == b"mine"
    with pytest.raises(FileMissingError, match="no such file"):
        logs.recover(tmp_path / "none.mcap")
    table = tmp_path / "table.parquet"
    table.write_bytes(b"PAR1 and more bytes than that, all of them good")
    with pytest.raises(LogError, match="is not an MCAP file"):
        logs.recover(table)


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("chunked", [True, False])
def test_damaged_file_of_somebody_else(tmp_path, compression, chunked):
    path = tmp_path / "robot.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=2000, compression=compression, use_chunking=chunked)
        writer.start("ros2")
        number = writer.register_channel("/odd", "json", writer.register_schema("odd.Thing", "jsonschema", b"{}"))
        for k in range(1000):
            writer.add_message(number, k, b'{"k": %d}' % k, k)
        writer.finish()
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * 0.4)])
    said = logs.recover(path)
    log = logs.read(said.path)
    assert log.kind == "foreign"
    numbers = log.others["/odd"]["k"].to_pylist()
    assert 50 < len(numbers) < 1000
    assert numbers == list(range(len(numbers)))
    # From a chunk that is not compressed, messages can be saved singly, without its checksum.
    alone = not chunked or compression == CompressionType.NONE
    assert any("they are unverified" in line for line in said.saved) == alone
    assert said.path.read_bytes().count(b"ros2") >= 1
