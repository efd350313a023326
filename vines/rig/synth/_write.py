"""Raw files of a synthetic run in the formats of laboratories."""

from __future__ import annotations

from pathlib import Path

from vines.errors import RigError
from vines.rig.formats import FORMATS, RawFile

__all__ = ["file_name", "write_raw"]


def file_name(form: str, recorder: str = "") -> str:
    """Return the name of a raw file.

    Examples
    --------
    >>> file_name("tdms"), file_name("hdf5", "daq")
    ('run.tdms', 'run_daq.h5')
    """
    suffix = FORMATS.get(form).suffixes[0]
    return f"run_{recorder}{suffix}" if recorder else f"run{suffix}"


def write_raw(path: Path, form: str, file: RawFile) -> None:
    """Write a raw file.

    Parameters
    ----------
    path : Path
        Where.
    form : str
        One of the formats of `RigSettings`.
    file : RawFile
        Channels of whole numbers, with ``slope`` in ``about``: the volts of one step.

    Raises
    ------
    RigError
        If a format of another package is only read.
    """
    write = FORMATS.get(form).write
    if write is None:
        raise RigError(f"files of the format {form!r} are read only")
    write(path, file.channels, started=file.started)
