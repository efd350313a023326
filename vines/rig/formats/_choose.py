"""Which reader a file needs, by its first bytes and then by its suffix, and one line for what it cannot be read as."""

from __future__ import annotations

import importlib
import warnings
from pathlib import Path

from vines.errors import FileMissingError, PackageMissingError, RigError
from vines.rig.formats._raw import RawFile

__all__ = ["FORMS", "read_file"]

FORMS = {
    "tdms": ("NI TDMS", (".tdms",)),
    "uff": ("UFF dataset 58", (".uff", ".unv", ".uf", ".bunv", ".ufb")),
    "mat": ("MATLAB", (".mat",)),
    "csv": ("CSV", (".csv", ".tsv", ".txt")),
    "hdf5": ("HDF5", (".h5", ".hdf5", ".hdf")),
    "wav": ("WAV", (".wav", ".wave")),
}
"""Name and suffixes of each format; the key is that of its module."""

_HDF5 = b"\x89HDF\r\n\x1a\n"


def read_file(path: Path) -> RawFile:
    """Read a file of a recorder.

    Parameters
    ----------
    path : Path
        NI TDMS, UFF dataset 58, MATLAB v4 to v7.3, CSV, HDF5 or WAV.

    Raises
    ------
    FileMissingError
        If there is no such file.
    RigError
        If it is of no known format, damaged, or holds no channels; one line with the reason.
    PackageMissingError
        If the library for its format is not installed.
    """
    if not path.is_file():
        raise FileMissingError(f"{path}: there is no such file")
    form = _form(path)
    reader = importlib.import_module(f"vines.rig.formats._{form}")
    try:
        with warnings.catch_warnings():
            # What the libraries warn about is either refused below or harmless, such as a missing index file.
            warnings.simplefilter("ignore")
            found = reader.read(path)
    except RigError as error:
        raise RigError(f"{path.name}: {error}") from None
    except PackageMissingError as error:
        raise PackageMissingError(f"{path.name}: {error}", name=error.name) from None
    except MemoryError:
        raise RigError(f"{path.name}: its header asks for more memory than there is; the file is damaged") from None
    except Exception as error:
        # The libraries raise whatever they stumble over in a damaged file; it is theirs, and the reason is in it.
        reason = " ".join(str(error).replace(str(path), "it").split()) or type(error).__name__
        raise RigError(f"{path.name} cannot be read as {FORMS[form][0]}: {reason[:200]}") from None
    if not found.channels:
        other = f"; it holds {', '.join(found.other[:4])}" if found.other else ""
        raise RigError(f"{path.name}: no channel with samples{other}")
    return found


def _form(path: Path) -> str:
    """Return the key of a file's format."""
    with path.open("rb") as stream:
        head = stream.read(1024)
    if not head:
        raise RigError(f"{path.name}: the file is empty")
    suffix = path.suffix.lower()
    if head[:4] in (b"TDSm", b"TDSh"):
        return "tdms"
    if head[:4] in (b"RIFF", b"RIFX", b"RF64"):
        return "wav"
    if head[:8] == _HDF5 or head[512:520] == _HDF5:
        return "mat" if head[:6] == b"MATLAB" or suffix == ".mat" else "hdf5"
    if head[:6] == b"MATLAB":
        return "mat"
    if head.lstrip(b" \r\n").startswith(b"-1"):
        return "uff"
    for key, (_, suffixes) in FORMS.items():
        if suffix in suffixes:
            return key
    known = ", ".join(f"{name} ({', '.join(suffixes)})" for name, suffixes in FORMS.values())
    raise RigError(f"{path.name}: no known format; read are {known}")
