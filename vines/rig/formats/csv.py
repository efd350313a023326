"""CSV and other text of loggers: a column a channel; how it is laid out is found and stated, or can be written down."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vines.rig.formats._csv import read
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel

__all__ = ["FORMAT", "read", "write"]


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str | None) -> None:
    """Write channels of one rate and start, see `Format`: units in the head, the rate in a note above or as times.

    A sample that is no number is an empty cell.
    """
    import pyarrow as pa
    import pyarrow.csv as pc

    names = [f"{each.name} [{each.unit}]" if each.unit else each.name for each in channels]
    columns = [np.asarray(each.values, np.float64) * float(each.about.get("slope", "1")) for each in channels]
    notes = f"# started: {started}\n" if started else ""
    times = channels[0].times
    if times is None:
        notes += f"# sampling_rate: {channels[0].rate!r}\n"
    else:
        names, columns = ["t [s]", *names], [times, *columns]
    with path.open("wb") as stream:
        stream.write((notes + ",".join(names) + "\n").encode())
        options = pc.WriteOptions(include_header=False)
        rows = pa.table([pa.array(values, from_pandas=True) for values in columns], names=names)
        pc.write_csv(rows, stream, write_options=options)


FORMAT = Format(
    name="csv",
    label="CSV",
    summary="names and units in the head or a row of their own, times or `# sampling_rate:`; layout found and stated",
    suffixes=(".csv", ".tsv", ".txt", ".asc", ".dat", ".prn", ".log"),
    read=read,
    dialects=True,
    write=write,
)
