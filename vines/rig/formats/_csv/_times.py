"""Which columns hold times, and what they are in seconds: a unit that is not stated is not made up."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.formats._csv._dates import read_date
from vines.rig.formats._csv._head import Name, is_unit
from vines.rig.formats._csv._layout import COUNTS, Layout
from vines.rig.formats._csv._table import day_seconds, measures, numbers
from vines.rig.units import si_factor

__all__ = ["TimeColumn", "counts_rows", "time_columns", "times_of"]

_DAY = 86400.0
_EPOCH = 1e8
"""[s] Times that begin later than this are counted from 1904, 1970 or the like."""


@dataclass(frozen=True, slots=True, eq=False)
class TimeColumn:
    """Times of the rows.

    Attributes
    ----------
    column : int
        Which column, from 1.
    unit : str
        As written, ``stamp`` or ``unknown``.
    times : ndarray of float64, shape (n,)
        In seconds, or in the unit that is not known.
    tick : float or None
        1, or None where the unit is not known.
    """

    column: int
    unit: str
    times: npt.NDArray[np.float64]
    tick: float | None


def time_columns(layout: Layout, stated: int | None) -> dict[int, list[int]]:
    """Return for each column of numbers which columns hold its times: the nearest ones before it, else the first.

    Parameters
    ----------
    layout : Layout
        Names, units and kinds.
    stated : int, optional
        The only one, from 1, or 0 for none.

    Returns
    -------
    dict of int to list of int
        Places from 0; columns of times and those that number the rows are left out.
    """
    every = range(len(layout.kinds))
    if stated is not None and stated > len(layout.kinds):
        raise RigError(f"column {stated} is stated to be the time, but there are {len(layout.kinds)} columns")
    found: dict[int, list[int]] = {}
    group: list[int] = []
    first: list[int] = []
    used = False
    for k in every:
        name, kind = layout.names[k], layout.kinds[k]
        if stated is None and _is_time(name, kind, between=used):
            group = [k] if used else [*group, k]
            first, used = first or group, False
        elif k == (stated or 0) - 1:
            group = first = [k]
        elif k == stated and layout.kinds[k - 1] == "stamp" and _is_time(name, kind, between=False):
            # Milliseconds of the stamps.
            group = first = [k - 1, k]
        elif kind == "number" and (used or not counts_rows(layout, k)):
            found[k], used = group, True
    return {k: own or first for k, own in found.items()}


def counts_rows(layout: Layout, k: int) -> bool:
    """Say whether a column numbers the rows: it is called so, or it is the first and alone without a name."""
    name = layout.names[k]
    alone = (
        k == 0
        and layout.head > 0
        and name.name == "1"
        and all(each.name != str(j + 1) for j, each in enumerate(layout.names[1:], 1))
    )
    return name.unit is None and (name.name.casefold() in COUNTS or alone)


def _is_time(name: Name, kind: str, *, between: bool) -> bool:
    """Say whether a column holds times; between channels a name alone is too little: a channel may be called x."""
    seconds = name.unit is not None and is_unit(name.unit) and si_factor(name.unit)[0] == "time"
    return kind == "stamp" or (kind == "number" and (seconds and name.time if between else seconds or name.time))


def times_of(
    table: Any, layout: Layout, places: Sequence[int], stated_unit: str, noted_unit: str
) -> tuple[TimeColumn, list[str]]:
    """Return the times that columns side by side give, and remarks: the finer one, or stamps with their milliseconds.

    Raises
    ------
    RigError
        If a time is missing.
    """
    units = {k: _unit(layout, k, stated_unit, noted_unit) for k in places}
    measured = {k: measures(table.column(k), layout.decimal, layout.names[k]) for k in layout.measured & {*places}}
    units |= {k: unit for k, (_, _, unit) in measured.items() if unit is not None}
    read: dict[int, Callable[[], npt.NDArray[np.float64]]] = {
        k: (lambda k=k: day_seconds(table.column(k)))
        if units[k] == "stamp"
        else (lambda k=k: measured[k][0])
        if k in measured
        else (lambda k=k: numbers(table.column(k), layout.decimal)[0])
        for k in places
    }
    values = {k: read[k]() for k in places}
    for k, column in values.items():
        if np.isnan(column).any():
            place = int(np.isnan(column).argmax())
            raise RigError(f"column {layout.names[k].name!r}: row {place + 1} of the samples has no time")
    stamp = next((k for k in places if units[k] == "stamp"), None)
    if stamp is not None:
        _check_days(table.column(stamp), values[stamp], layout.names[stamp].name)
    if stamp is not None and (parts := _thousandths(values, units, stamp)) is not None:
        return TimeColumn(stamp + 1, "stamp", values[stamp] + 1e-3 * parts, 1.0), []
    best = max(places, key=lambda k: len(np.unique(values[k][:4096])))
    unit, times = units[best], values[best]
    if unit == "unknown":
        text = (
            f"column {layout.names[best].name!r} holds times without a unit: write time_unit=s or the like into dialect"
        )
        return TimeColumn(best + 1, unit, times, None), [text]
    times = times if unit == "stamp" else times * si_factor(unit)[1]
    return TimeColumn(best + 1, unit, times - (times[0] if abs(times[0]) > _EPOCH else 0.0), 1.0), []


def _check_days(column: Any, seconds: npt.NDArray[np.float64], name: str) -> None:
    """Refuse stamps whose times pass midnight more or less often than their dates: a day may be missing between two."""
    first, last = (read_date(column[place].as_py()) for place in (0, len(column) - 1))
    if first is None or last is None:
        return
    days, counted = (last - first).days, int(seconds[-1] // _DAY)
    if days != counted:
        raise RigError(
            f"column {name!r}: its dates go from {first} to {last}, its times pass midnight {counted} times: samples "
            "are missing or the dates are wrong"
        )


def _unit(layout: Layout, k: int, stated: str, noted: str) -> str:
    """Return the unit of a column of times as it is stated, as its head says, or else the text above."""
    if layout.kinds[k] == "stamp":
        return "stamp"
    if stated and stated != "stamp":
        return stated
    unit = layout.names[k].unit
    if unit is not None and is_unit(unit) and si_factor(unit)[0] == "time":
        return unit
    return "unknown" if unit is not None else noted or "unknown"


def _thousandths(
    values: dict[int, npt.NDArray[np.float64]], units: dict[int, str], stamp: int
) -> npt.NDArray[np.float64] | None:
    """Return a column beside whole seconds that holds their milliseconds."""
    if np.any(values[stamp] % 1):
        return None
    for k, unit in units.items():
        if k != stamp and unit == "ms" and ((values[k] >= 0) & (values[k] < 1000)).all():
            return values[k]
    return None
