"""How long a run is watched, and how exactly it must repeat."""

from __future__ import annotations

from dataclasses import dataclass

from vines.bounds import MOST_EVENTS, check_count, check_number, check_periods
from vines.domains import Choice, Number, Whole
from vines.dynamics.runs import EVENTS_PER_PERIOD, IN_TURN, TIES
from vines.errors import StateError

__all__ = ["LARGEST_P", "Patience"]

LARGEST_P = 32
"""Largest number of forcing periods over which a repetition is looked for, where nothing is said."""

MOST_P = 4096
"""The most that may be asked for; the work of a look grows with it."""

ROUGH = 1e-4
"""Largest tolerance: what repeats only to within this is not told from a slow approach."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long to run, and how exactly a run must repeat; see `settle`.

    Raises
    ------
    StateError
        If an option is out of range.
    """

    settle: float = 400
    record: float = 64
    patience: float = 4000
    watch: float = 512
    tolerance: float = 1e-10
    cap: int = EVENTS_PER_PERIOD
    largest_p: int | None = None
    ties: str = IN_TURN

    def __post_init__(self) -> None:
        for name, value, least in (
            ("settle", self.settle, 0),
            ("record", self.record, 2),
            ("patience", self.patience, 0),
            ("watch", self.watch, 16),
        ):
            check_periods(name, check_number(name, value, least=least, unit=" periods"))
        check_number("tolerance", self.tolerance, above=0, most=ROUGH)
        check_count("max_impacts_per_period", self.cap, most=MOST_EVENTS)
        if self.largest_p is not None:
            check_count("largest_p", self.largest_p, most=MOST_P)
        Choice(TIES).check("ties", self.ties, StateError)
        for name in ("settle", "record", "patience", "watch", "tolerance"):
            object.__setattr__(self, name, Number().plain(getattr(self, name)))
        for name in ("cap", "largest_p"):
            object.__setattr__(self, name, Whole().plain(getattr(self, name)))

    def check_length(self, period: float) -> None:
        """Raise `StateError` if runs of a forcing period would take years."""
        for name in ("settle", "record", "patience", "watch"):
            check_periods(name, getattr(self, name), period)

    @property
    def longest(self) -> int:
        """Largest number of forcing periods over which a repetition is looked for."""
        return LARGEST_P if self.largest_p is None else self.largest_p

    @property
    def window(self) -> float:
        """Forcing periods to record: as many as asked for, and twice `largest_p` where that is asked for."""
        return float(self.record if self.largest_p is None else max(self.record, 2 * self.largest_p))
