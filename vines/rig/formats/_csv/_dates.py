"""Dates before times of the day, where they can be read in one way only."""

from __future__ import annotations

import re
from datetime import date

__all__ = ["read_date", "start_of"]

_YEAR_FIRST = re.compile(r"\s*(?P<y>\d{4})[-/.](?P<m>\d\d?)[-/.](?P<d>\d\d?)(?P<rest>(?:[T ,]|$).*)")
_DAY_FIRST = re.compile(r"\s*(?P<d>\d\d?)\.(?P<m>\d\d?)\.(?P<y>\d{4})(?P<rest>(?:[T ,]|$).*)")
_TIME = re.compile(r"[T ,]\s*(\d\d):(\d\d):(\d\d)(?:[.,](\d+))?\s*(Z|UTC|GMT|[+-]\d\d:?\d\d)?\s*")


def read_date(cell: str) -> date | None:
    """Return the date of a stamp: year first, or with full stops and then day first. With slashes its order is open.

    Examples
    --------
    >>> read_date("2026-03-02T09:00:00Z"), read_date("2.3.2026 9:00:00,5"), read_date("2/3/2026 9:00:00")
    (datetime.date(2026, 3, 2), datetime.date(2026, 3, 2), None)
    """
    found = _YEAR_FIRST.match(cell) or _DAY_FIRST.match(cell)
    if found is None:
        return None
    try:
        return date(int(found["y"]), int(found["m"]), int(found["d"]))
    except ValueError:
        return None


def start_of(cell: str) -> str | None:
    """Return a stamp as ISO 8601, with its zone if it has one; None if its date or time cannot be read.

    Examples
    --------
    >>> start_of("2026-03-02 09:00:00.25Z"), start_of("02.03.2026 09:00:00"), start_of("09:00:00")
    ('2026-03-02T09:00:00.25Z', '2026-03-02T09:00:00', None)
    """
    day = read_date(cell)
    whole = _YEAR_FIRST.match(cell) or _DAY_FIRST.match(cell)
    time = _TIME.fullmatch(whole["rest"]) if whole else None
    if day is None or time is None:
        return None
    hours, minutes, seconds, fraction, zone = time.groups()
    part = f".{fraction}" if fraction else ""
    return f"{day.isoformat()}T{hours}:{minutes}:{seconds}{part}{'Z' if zone in ('Z', 'UTC', 'GMT') else zone or ''}"
