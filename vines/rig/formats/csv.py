"""CSV and other text of loggers: a column a channel; how it is laid out is found and stated, or can be written down."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vines.rig.formats._csv import read
from vines.rig.formats._format import Format
from vines.rig.formats._raw import RawChannel

__all__ = ["FORMAT", "read", "write"]


def write(path: Path, channels: tuple[RawChannel, ...], *, started: str) -> None:
    """Write channels of one rate and start with their units in the head and the rate in a note above, see `Format`."""
    import pyarrow as pa
    import pyarrow.csv as pc

    names = [f"{each.name} [{each.unit}]" if each.unit else each.name for each in channels]
    columns = [np.asarray(each.values, np.float64) * float(each.about.get("slope", "1")) for each in channels]
    with path.open("wb") as stream:
        stream.write(f"# started: {started}\n# sampling_rate: {channels[0].rate!r}\n".encode())
        stream.write((",".join(names) + "\n").encode())
        options = pc.WriteOptions(include_header=False)
        pc.write_csv(pa.table(columns, names=names), stream, write_options=options)


FORMAT = Format(
    name="csv",
    label="CSV",
    summary="names and units in the head or a row of their own, times or `# sampling_rate:`; layout found and stated",
    suffixes=(".csv", ".tsv", ".txt", ".asc", ".dat", ".prn", ".log"),
    read=read,
    dialects=True,
    write=write,
)
