"""Raw files of a synthetic run in the formats of laboratories."""

from __future__ import annotations

import importlib
from pathlib import Path

from vines.rig.formats import RawFile

__all__ = ["file_name", "write_raw"]

_SUFFIX = {"tdms": "tdms", "uff": "uff", "mat": "mat", "mat73": "mat", "csv": "csv", "hdf5": "h5", "wav": "wav"}


def file_name(form: str, recorder: str = "") -> str:
    """Return the name of a raw file.

    Examples
    --------
    >>> file_name("tdms"), file_name("hdf5", "daq")
    ('run.tdms', 'run_daq.h5')
    """
    return f"run_{recorder}.{_SUFFIX[form]}" if recorder else f"run.{_SUFFIX[form]}"


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
    """
    module = "mat" if form == "mat73" else form
    writer = importlib.import_module(f"vines.rig.formats._{module}")
    write = writer.write_73 if form == "mat73" else writer.write
    write(path, file.channels, started=file.started)
