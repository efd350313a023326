"""Streams from the files that appear in a folder, each once it is complete."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from vines.errors import FileMissingError, RigError, VinesError
from vines.rig.formats import FORMATS, RawChannel, RawFile, read_file
from vines.rig.ingest import Cells, channel_facts, known_channels, read_cells, spread_all
from vines.rig.watch._channel import channels_of
from vines.rig.watch._stream import IDLE, Block, Refusal, Stream, check_rate

__all__ = ["STEADY", "FolderSource", "described_file"]

STEADY = 2.0
"""Seconds for which a file must not have changed to be taken for complete."""
_LOOK = 0.5
"""Seconds between two looks into the folder."""
_BLOCK = 0.5
"""Seconds of a block."""
_NOT = ("derived", "sealed", "watched", "channels.tsv")
"""Folders whose files are no recordings, and what lies beside recordings."""


class FolderSource:
    """Recordings that appear in a folder or below it.

    Parameters
    ----------
    folder : Path
        Where recorders put their files; a campaign or a run folder too.
    rows : sequence of Cells
        ``channels.tsv`` of the recordings; where it is empty that of the run folder or campaign in which a file lies
        counts, else what the file says of itself.
    steady : float
        Seconds for which a file must not have changed.
    present : bool
        Whether files that are there at the beginning are looked at too.

    Raises
    ------
    FileMissingError
        If there is no such folder.
    """

    live = False

    def __init__(self, folder: Path, rows: Sequence[Cells] = (), *, steady: float = STEADY, present: bool = False):
        if not folder.is_dir():
            raise FileMissingError(f"{folder}: there is no such folder")
        self._folder, self._rows, self._steady = folder, rows, steady
        self._suffixes = {suffix for each in FORMATS.all().values() for suffix in each.suffixes} - {".mcap"}
        self._taken: dict[Path, tuple[int, int]] = {} if present else dict(self._there())

    def streams(self) -> Iterator[Stream | Refusal | None]:
        """Yield each file that is complete, and why one cannot be read."""
        changed: dict[Path, tuple[tuple[int, int], float]] = {}
        while True:
            found = False
            for path, state in self._there():
                if self._taken.get(path) == state:
                    continue
                known = changed.get(path)
                if known is None or known[0] != state:
                    changed[path] = (state, time.monotonic())
                elif time.monotonic() - known[1] >= self._steady and state[0]:
                    self._taken[path] = state
                    found = True
                    yield self._read(path)
            if not found:
                yield None
                time.sleep(min(_LOOK, max(IDLE, self._steady / 4)) if self._steady else 0.02)

    def close(self) -> None:
        """Nothing is held."""

    def _there(self) -> Iterator[tuple[Path, tuple[int, int]]]:
        """Yield the recordings, with size and time of their last change."""
        for path in sorted(self._folder.rglob("*")):
            parts = path.relative_to(self._folder).parts
            if path.suffix.lower() not in self._suffixes or any(part.startswith(".") or part in _NOT for part in parts):
                continue
            try:
                told = path.stat()
            except OSError:  # it was moved in between
                continue
            if path.is_file():
                yield path, (told.st_size, told.st_mtime_ns)

    def _read(self, path: Path) -> Stream | Refusal:
        try:
            return described_file(path, self._rows or self._stated(path))
        except VinesError as error:
            return Refusal(path, str(error))

    def _stated(self, path: Path) -> Sequence[Cells]:
        """Return the nearest ``channels.tsv`` above a file: that of its run folder over that of its campaign."""
        rows: dict[str, Cells] = {}
        above = [parent for parent in path.parents if parent.is_relative_to(self._folder.parent)]
        for parent in reversed(above):
            if (parent / "channels.tsv").is_file():
                for row in read_cells(parent / "channels.tsv"):
                    before = rows[row.name].cells if row.name in rows else {}
                    rows[row.name] = Cells({**before, **row.cells}, row.where)
        return tuple(rows.values())


def described_file(path: Path, rows: Sequence[Cells] = ()) -> Stream:
    """Return a file of a recorder as a stream.

    Parameters
    ----------
    path : Path
        The file.
    rows : sequence of Cells
        Its channels as ``channels.tsv`` has them, by their fields; if there are none, what the file says of itself.

    Raises
    ------
    RigError, FileMissingError
        If it cannot be read, or no channel of it is described.
    """
    file = read_file(path, next((row.cells["dialect"] for row in rows if "dialect" in row.cells), ""))
    remarks = list(file.remarks)
    told = _described(path, file, rows, remarks)
    rates = {row.name: _rate(row, channel) for row, channel in told}
    good = Counter(rate for rate in rates.values() if rate)
    if not good:
        raise RigError(f"{path.name}: no rate; write fs into channels.tsv")
    rate = good.most_common(1)[0][0]
    kept = [(row, channel) for row, channel in told if rates[row.name] == rate]
    remarks += [f"{row.name}: another rate, not watched" for row, _ in told if rates[row.name] != rate]
    channels = channels_of([row for row, _ in kept])
    count = min(len(channel.values) for _, channel in kept)
    values = np.stack([np.asarray(channel.values[:count], np.float64) for _, channel in kept])
    return Stream(
        name=path.stem,
        channels=channels,
        rate=check_rate(rate, path.name),
        blocks=_pieces(values, rate),
        dtype="<f8",
        run={"start_utc": file.started} if file.started else {},
        file=path,
        remarks=tuple(remarks),
    )


def _described(path: Path, file: RawFile, rows: Sequence[Cells], remarks: list[str]) -> list[tuple[Cells, RawChannel]]:
    """Return the channels of a file that are described, with their rows."""
    if rows:
        found = []
        for row in spread_all(rows):
            field = row.cells.get("field", row.name)
            exact = [each for each in file.channels if each.name == field]
            last = [each for each in file.channels if each.name.rpartition("/")[2] == field.rpartition("/")[2]]
            if len(exact or last) == 1:
                found.append((row, (exact or last)[0]))
            else:
                remarks.append(f"{row.name}: no channel {field!r} in it")
        if found:
            return found
        raise RigError(f"{path.name}: none of its channels ({', '.join(c.name for c in file.channels)}) is described")
    proposed = [Cells({"sign": "+1", **row}, path.name) for row in known_channels(path.name, file)[0]]
    known = [row for row in proposed if row.cells.get("role") and row.cells.get("unit")]
    if not known:
        raise RigError(
            f"{path.name}: what its channels measure is not known ({', '.join(c.name for c in file.channels)}); give "
            "--channels FILE.tsv with their field, name, role, unit and sign"
        )
    remarks.append("signs are not stated, +1 is taken: left and right may be swapped")
    return [(row, file.channel(row.cells["field"])) for row in known]


def _rate(row: Cells, channel: RawChannel) -> float | None:
    stated = row.cells.get("fs", "file")
    if stated != "file":
        try:
            return float(stated)
        except ValueError:
            raise RigError(f"{row.where}: fs of {row.name} is {stated!r}, which is no number") from None
    return channel_facts(channel).rate


def _pieces(values: np.ndarray, rate: float) -> Iterator[Block]:
    size = max(1, round(_BLOCK * rate))
    for first in range(0, values.shape[1], size):
        yield Block(first, values[:, first : first + size])
