"""Which reader a file needs, by its first bytes and then by its suffix, and one line for what it cannot be read as."""

from __future__ import annotations

import warnings
from pathlib import Path

from vines.errors import FileMissingError, PackageMissingError, RigError, is_of_the_machine
from vines.rig.formats._format import FORMATS, Format
from vines.rig.formats._raw import RawFile

__all__ = ["read_file"]


def read_file(path: Path, dialect: str = "") -> RawFile:
    """Read a file of a recorder.

    Parameters
    ----------
    path : Path
        NI TDMS, UFF dataset 58, MATLAB v4 to v7.3, LabVIEW LVM, text, HDF5, WAV, or what another package reads.
    dialect : str
        How a file of text is laid out, as far as that is stated, such as ``separator=semicolon time_unit=ms``.

    Raises
    ------
    FileMissingError
        If there is no such file.
    RigError
        If it is of no known format, damaged, or holds no channels; one line with the reason.
    PackageMissingError
        If the library for its format is not installed.
    PlugInError
        If the format of an installed package cannot be used.
    """
    if not path.is_file():
        raise FileMissingError(f"{path}: there is no such file")
    form = _format_of(path)
    if dialect and not form.dialects:
        raise RigError(f"{path.name}: a dialect is stated, but it is {form.label}, which has none")
    try:
        with warnings.catch_warnings():
            # What the libraries warn about is either refused below or harmless, such as a missing index file.
            warnings.simplefilter("ignore")
            found = form.read(path, dialect) if form.dialects else form.read(path)
    except RigError as error:
        raise RigError(f"{path.name}: {error}") from None
    except PackageMissingError as error:
        raise PackageMissingError(f"{path.name}: {error}", name=error.name) from None
    except MemoryError:
        raise RigError(f"{path.name}: its header asks for more memory than there is; the file is damaged") from None
    except Exception as error:
        if is_of_the_machine(error) or isinstance(error, PermissionError):
            raise RigError(f"{path.name} cannot be read: {getattr(error, 'strerror', error)}") from None
        # The libraries raise whatever they stumble over in a damaged file; it is theirs, and the reason is in it.
        reason = " ".join(str(error).replace(str(path), "it").split()) or type(error).__name__
        raise RigError(f"{path.name} cannot be read as {form.label}: {reason[:200]}") from None
    if not found.channels:
        other = f"; it holds {', '.join(found.other[:4])}" if found.other else ""
        raise RigError(f"{path.name}: no channel with samples{other}")
    return found


def _format_of(path: Path) -> Format:
    with path.open("rb") as stream:
        head = stream.read(1024)
    if not head:
        raise RigError(f"{path.name}: the file is empty")
    suffix = path.suffix.lower()
    formats = FORMATS.all().values()
    for each in formats:
        if each.begins is not None and each.begins(head, suffix):
            return each
    for each in formats:
        if suffix in each.suffixes:
            return each
    known = ", ".join(f"{each.label} ({', '.join(each.suffixes)})" for each in formats)
    raise RigError(f"{path.name}: no known format; read are {known}")
