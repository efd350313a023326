"""Units that laboratories write, in SI. What is not in the table is refused, never guessed."""

from __future__ import annotations

import re

from vines.errors import RigError, nearest

__all__ = ["UNITS", "si_factor", "volts_per_unit"]

UNITS: dict[str, tuple[str, float]] = {
    "V": ("voltage", 1.0),
    "mV": ("voltage", 1e-3),
    "uV": ("voltage", 1e-6),
    "m": ("displacement", 1.0),
    "cm": ("displacement", 1e-2),
    "mm": ("displacement", 1e-3),
    "um": ("displacement", 1e-6),
    "nm": ("displacement", 1e-9),
    "in": ("displacement", 0.0254),
    "mil": ("displacement", 2.54e-5),
    "m/s": ("velocity", 1.0),
    "mm/s": ("velocity", 1e-3),
    "um/s": ("velocity", 1e-6),
    "in/s": ("velocity", 0.0254),
    "m/s^2": ("acceleration", 1.0),
    "mm/s^2": ("acceleration", 1e-3),
    "g": ("acceleration", 9.80665),
    "mg": ("acceleration", 9.80665e-3),
    "N": ("force", 1.0),
    "kN": ("force", 1e3),
    "s": ("time", 1.0),
    "ms": ("time", 1e-3),
    "us": ("time", 1e-6),
    "Pa": ("pressure", 1.0),
    "degC": ("temperature", 1.0),
}
"""Quantity and factor to SI of each unit."""

_OTHER = {
    "volt": "V", "volts": "V", "v": "V", "mv": "mV", "µm": "um", "μm": "um", "micron": "um", "µs": "us", "μs": "us",
    "µV": "uV", "μV": "uV", "g_n": "g", "gn": "g", "G": "g", "gs": "g", "meter": "m", "metre": "m", "meters": "m",
    "metres": "m", "mil.": "mil", "sec": "s", "seconds": "s", "second": "s", "°C": "degC", "℃": "degC",
    "m/s2": "m/s^2", "m/s²": "m/s^2", "m/s/s": "m/s^2", "m s^-2": "m/s^2", "m/s**2": "m/s^2", "ms^-2": "m/s^2",
    "mm/s2": "mm/s^2", "mm/s²": "mm/s^2", "mm/s**2": "mm/s^2", "inch": "in", "µm/s": "um/s", "μm/s": "um/s",
    "newton": "N",
}  # fmt: skip
"""Other spellings that are in use."""


def si_factor(unit: str) -> tuple[str, float]:
    """Return the quantity of a unit and what one of it is in SI.

    Raises
    ------
    RigError
        If it is not in the table.

    Examples
    --------
    >>> si_factor("mm"), si_factor("g")
    (('displacement', 0.001), ('acceleration', 9.80665))
    >>> si_factor("µm") == si_factor("um")
    True
    """
    text = " ".join(unit.split()).strip("[]() ")
    known = _OTHER.get(text, text)
    if known not in UNITS:
        raise RigError(f"unit {unit!r} is not known: {nearest(text, UNITS)}")
    return UNITS[known]


def volts_per_unit(sensitivity: float, unit: str) -> tuple[str, float]:
    """Return what a sensor measures and its volts an SI unit.

    Parameters
    ----------
    sensitivity : float
        The number of the calibration sheet.
    unit : str
        Its unit, electrical over mechanical (``mV/g``, ``V/(m/s^2)``, ``V/mm``) or the inverse (``mm/V``).

    Returns
    -------
    quantity : str
        Such as ``displacement``.
    volts : float
        Volts an SI unit of it.

    Raises
    ------
    RigError
        If the unit is of another form or not known, or the number is not positive.

    Examples
    --------
    >>> quantity, volts = volts_per_unit(100.0, "mV/g")
    >>> quantity, round(volts, 9)
    ('acceleration', 0.010197162)
    >>> volts_per_unit(0.5, "mm/V")
    ('displacement', 2000.0)
    """
    if not sensitivity > 0 or sensitivity == float("inf"):
        raise RigError(f"sensitivity {sensitivity:g} {unit}: it must be a positive number; the sign has its own column")
    text = unit.strip()
    # The slash that parts the two is the first or the last outside of brackets and not the one inside m/s.
    for match in re.finditer("/", text):
        above, below = text[: match.start()], text[match.end() :]
        try:
            upper, lower = si_factor(above), si_factor(below)
        except RigError:
            continue
        if upper[0] == "voltage" and lower[0] != "voltage":
            return lower[0], sensitivity * upper[1] / lower[1]
        if lower[0] == "voltage" and upper[0] != "voltage":
            return upper[0], lower[1] / (sensitivity * upper[1])
    raise RigError(
        f"sensitivity unit {unit!r} is not one of volts over a mechanical unit or the inverse, such as mV/g, "
        "V/(m/s^2), V/mm, mm/V"
    )
