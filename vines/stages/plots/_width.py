"""Widths of pictures, with their unit."""

from __future__ import annotations

import re

from vines.errors import DeclarationError

__all__ = ["inches"]

_UNITS = {"mm": 1 / 25.4, "cm": 1 / 2.54, "in": 1.0, "pt": 1 / 72}
_WIDTH = re.compile(r"\s*(?P<number>\d*\.?\d+)\s*(?P<unit>[a-z]+)\s*")
_LEAST, _MOST = 1.5, 20.0
"""Inches; less holds no axis with numbers, more is a mistake of units."""


def inches(width: float | str, name: str = "width") -> float:
    """Return the width of a picture [inch].

    Parameters
    ----------
    width : float or str
        A number is inches; a text has its unit, mm, cm, in or pt.
    name : str
        What a declaration calls it.

    Raises
    ------
    DeclarationError
        If it is neither, or not from 1.5 to 20 inches (38 to 508 mm).

    Examples
    --------
    >>> f"{inches('85mm'):.3f}", inches(7.0)
    ('3.346', 7.0)
    >>> inches(85)
    Traceback (most recent call last):
        ...
    vines.errors.DeclarationError: width is 85 inch; allowed is 1.5 to 20 inch (38 to 508 mm); write "85mm" for mm
    """
    if isinstance(width, str):
        found = _WIDTH.fullmatch(width)
        if found is None or found["unit"] not in _UNITS:
            raise DeclarationError(f'{name} is {width!r}; allowed is a number with mm, cm, in or pt, such as "85mm"')
        number = float(found["number"]) * _UNITS[found["unit"]]
    else:
        number = float(width)
    if not _LEAST <= number <= _MOST:
        said = repr(width) if isinstance(width, str) else f"{width:g} inch"
        meant = f'; write "{width:g}mm" for mm' if not isinstance(width, str) and 38 <= width <= 508 else ""
        raise DeclarationError(f"{name} is {said}; allowed is 1.5 to 20 inch (38 to 508 mm){meant}")
    return number
