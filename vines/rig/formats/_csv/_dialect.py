"""How a file of text is laid out: found, shown by ``inspect``, or written down in ``channels.tsv``."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from vines.errors import RigError, nearest
from vines.rig.units import si_factor

__all__ = ["DECIMALS", "SEPARATORS", "Dialect", "stated_dialect"]

SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "space": " ", "none": ""}
DECIMALS = {"point": ".", "comma": ","}


@dataclass(frozen=True, slots=True)
class Dialect:
    """Layout of a file of text. Lines and columns count from 1; 0 says that there is none.

    Attributes
    ----------
    encoding : str
        Such as ``utf-8``.
    separator, decimal : str
        Words of `SEPARATORS`, and ``point`` or ``comma``. A space stands for any number of blanks.
    head, units, data : int
        Lines of the names, of the units where they have one of their own, and of the first samples.
    time : int
        Column of the times.
    time_unit : str
        Their unit, ``stamp`` for times of the day, ``unknown`` where the file says none.

    Examples
    --------
    >>> print(Dialect("utf-8", "semicolon", "comma", 1, 0, 2, 1, "ms"))
    encoding=utf-8 separator=semicolon decimal=comma head=1 units=0 data=2 time=1 time_unit=ms
    """

    encoding: str
    separator: str
    decimal: str
    head: int
    units: int
    data: int
    time: int
    time_unit: str

    def __str__(self) -> str:
        return " ".join(f"{name}={value}" for name, value in asdict(self).items())


def stated_dialect(text: str) -> dict[str, Any]:
    """Return what a cell of ``channels.tsv`` states of a dialect; what it leaves out is found.

    Raises
    ------
    RigError
        If a part of it is not of the form key=value, or not one that can be.

    Examples
    --------
    >>> stated_dialect("separator=semicolon decimal=comma time_unit=ms head=3")
    {'separator': 'semicolon', 'decimal': 'comma', 'time_unit': 'ms', 'head': 3}
    """
    found: dict[str, Any] = {}
    known = [field.name for field in fields(Dialect)]
    for part in text.split():
        key, sign, value = part.partition("=")
        if not sign or key not in known:
            raise RigError(f"dialect {part!r}: a part is KEY=VALUE, and there is no such key: {nearest(key, known)}")
        allowed = {"separator": SEPARATORS, "decimal": DECIMALS}.get(key)
        if allowed is not None and value not in allowed:
            raise RigError(f"dialect {part!r}: allowed for {key} are {', '.join(allowed)}")
        if key in ("head", "units", "data", "time"):
            if not value.isdecimal():
                raise RigError(f"dialect {part!r}: {key} is the number of a line or column, 0 for none")
            found[key] = int(value)
        elif key == "time_unit" and value not in ("stamp", "unknown") and si_factor(value)[0] != "time":
            raise RigError(f"dialect {part!r}: it is no unit of time, such as s, ms, us, min; or write stamp")
        else:
            found[key] = value
    return found
