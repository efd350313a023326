"""What a format of recordings is, and which formats there are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from vines.doors import Register
from vines.errors import RigError
from vines.rig.formats._raw import RawFile

__all__ = ["FORMATS", "Format", "list_formats", "readers"]


@dataclass(frozen=True, slots=True)
class Format:
    """A format of files of recorders: everything that is known of it.

    Its module imports the library of the format inside functions only: formats are listed without any.

    Attributes
    ----------
    name : str
        Short name, that of the entry point.
    label : str
        How messages call it, such as ``NI TDMS``.
    summary : str
        What is taken from a file, in one line.
    suffixes : tuple of str
        Usual ones, in lower case with their dots; they decide where no beginning of a file does.
    read : callable
        ``read(path)`` returns the :class:`RawFile` of a file. Whatever it raises becomes one line; a
        :class:`vines.errors.RigError` says a reason of its own.
    begins : callable, optional
        ``begins(head, suffix)`` says whether a file with these first 1024 bytes and that suffix is of the format.
    dialects : bool
        Whether it is text of many layouts: ``read(path, dialect)`` then takes what ``channels.tsv`` states of one.
    write : callable, optional
        ``write(path, channels, started=...)``, by which a synthetic rig writes such a file: a tuple of
        :class:`RawChannel`, with floating samples or the steps of a converter (int32, the value of one step as
        ``slope`` in `about`); `started` is ISO 8601 in UTC.

    Examples
    --------
    >>> FORMATS.get("tdms").label
    'NI TDMS'
    """

    name: str
    label: str
    summary: str
    suffixes: tuple[str, ...]
    read: Callable[..., RawFile]
    begins: Callable[[bytes, str], bool] | None = None
    write: Callable[..., None] | None = None
    dialects: bool = False


FORMATS: Register[Format] = Register("format", "vines.formats", Format, RigError)
"""The formats that are known. Another package brings one by an entry point of the group ``vines.formats``."""

FORMATS.add_modules("vines.rig.formats", "FORMAT")


def list_formats() -> list[dict[str, Any]]:
    """Return name, label, suffixes and summary of the formats, and the package that brings each if not vines."""
    return [
        {
            "name": name,
            "label": each.label,
            "suffixes": list(each.suffixes),
            "summary": each.summary,
            "package": FORMATS.origin(name),
        }
        for name, each in FORMATS.all().items()
    ]


def readers() -> tuple[str, ...]:
    """Return the readers of all formats, ``package.module:function``: their code counts in what is read from files."""
    return tuple(dict.fromkeys(f"{each.read.__module__}:{each.read.__qualname__}" for each in FORMATS.all().values()))
