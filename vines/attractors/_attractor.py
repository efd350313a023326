"""What a simulation settled to."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures
from vines.html import html_table

__all__ = ["Attractor"]


UNSEEN = 0.05
"""Chance of seeing no escape at the rate that `escape_rate` gives."""


@dataclass(frozen=True, slots=True)
class Attractor:
    """What a simulation settled to, with its measures; everything dimensionless.

    Attributes
    ----------
    params : Params, or those of another system
        Parameters of the run.
    regime : str
        ``periodic``, ``quasiperiodic``, ``chaotic``, ``no_impact`` or ``unsettled``.
    settled : bool
        Whether the run reached its attractor; for a periodic one, to the tolerance asked for.
    word : str or None
        If periodic, the contacts over p forcing periods in canonical rotation, such as ``LLR`` or ``LRLR/2T``; a
        complete chatter, after which the ball sticks, counts as one contact and has a star: ``L*R``.
    name : str or None
        If periodic, n:m/pT (paper, section 3.1), such as ``2:1`` or ``2:2/2T``.
    n, m, p : int or None
        If periodic, contacts on L and on R in p forcing periods, the smallest such p.
    symmetric : bool or None
        If periodic, whether it is its own mirror image (x, t) -> (-x, t + pT/2).
    sticks : float
        Spells of sticking per forcing period.
    sticking_share : float
        Share of the forcing periods in which the ball sticks for a while.
    recurrent_sticking : bool
        Whether sticking recurs: it is part of a periodic orbit, or there is some in at least nine periods of ten.
    measures : Measures
        Over p forcing periods if periodic, else over the recorded window.
    kinetic_ratio_error, max_abs_x1_error, rms_x1_error : float
        Standard errors of these measures over a window as long as the recorded one (`recorded` periods; the largest
        |x1| of chaos grows with it). 0 if regular, nan where none can be told: `reason` says why.
    impacts : structured ndarray
        Recorded impacts, as `Trajectory.impacts`, t counted from the start of the recording.
    final : dict
        State at the end of the recording: the coordinates of the system (x1, v1, x2, v2), t and forcing phase [rad].
    lyapunov, lyapunov_error : float
        Largest Lyapunov exponent per unit of time and its standard error; nan if not asked for.
    exponents : ndarray, shape (d,)
        The spectrum in descending order, -inf for directions that sticking removes.
    multipliers : ndarray of complex, shape (d,), or None
        If periodic, its Floquet multipliers over p periods, the largest first.
    remaining : float
        Estimated forcing periods still needed if not settled, nan where no estimate can be made; else 0.
    transient : float
        Forcing periods run before the recording: those asked for and those that patience added.
    recorded : float
        Forcing periods recorded.
    watched : float
        Forcing periods, those recorded included, over which a motion that never repeated was seen to last; 0 where it
        was not watched for longer.
    status : str
        ``complete``, ``impact_cap`` or ``step_limit``.
    reason : str
        Why it is called unsettled, or what was noted on the way; empty if nothing.
    """

    params: Any
    regime: str
    settled: bool
    word: str | None
    name: str | None
    n: int | None
    m: int | None
    p: int | None
    symmetric: bool | None
    sticks: float
    sticking_share: float
    recurrent_sticking: bool
    measures: Measures
    kinetic_ratio_error: float
    max_abs_x1_error: float
    rms_x1_error: float
    impacts: npt.NDArray[np.void] = field(repr=False)
    final: dict[str, float]
    lyapunov: float
    lyapunov_error: float
    exponents: npt.NDArray[np.float64]
    multipliers: npt.NDArray[np.complex128] | None
    remaining: float
    transient: float
    recorded: float
    watched: float
    status: str
    reason: str

    @property
    def max_multiplier(self) -> float:
        """Largest modulus of a Floquet multiplier over p periods; nan if not periodic."""
        return float("nan") if self.multipliers is None else float(abs(self.multipliers[0]))

    @property
    def escape_rate(self) -> float:
        """Largest rate, per forcing period, at which chaos may be left: a greater one would show in 19 of 20 runs.

        From a time watched without an escape, -ln(.05)/watched (docs/dynamics.md); nan if not chaotic.
        """
        return -math.log(UNSEEN) / self.watched if self.regime == "chaotic" and self.watched else float("nan")

    def _kind(self) -> str:
        return f"{self.name} ({self.word})" if self.word else self.regime.replace("_", " ")

    def __str__(self) -> str:
        m = self.measures
        said = ["settled" if self.settled else f"not settled after {self.transient + self.recorded:g} periods"]
        if self.symmetric is not None:
            said.append("symmetric" if self.symmetric else "asymmetric")
        if np.isfinite(m.kinetic_ratio):  # a shaken cavity has no oscillator
            said.append(f"K2/K1 {m.kinetic_ratio:.6g}, max|x1| {m.max_abs_x1:.6g}")
        if self.multipliers is not None:
            said.append(f"largest multiplier {self.max_multiplier:.6g}")
        if self.regime == "chaotic" and self.settled:
            said.append(f"watched for {self.watched:g} periods, left with <= {self.escape_rate:.2g} a period (95 %)")
        if np.isfinite(self.lyapunov):
            said.append(f"Lyapunov exponent {self.lyapunov:.3g} ± {self.lyapunov_error:.1g}")
        return f"{self._kind()} at {self.params}: {', '.join(said)}" + (f"; {self.reason}" if self.reason else "")

    def __repr__(self) -> str:
        return f"<Attractor {self}>"

    def _repr_html_(self) -> str:
        """Return the attractor as a small table, which a notebook shows."""
        m, chaos, moves = self.measures, np.isfinite(self.lyapunov), np.isfinite(self.measures.kinetic_ratio)
        return html_table(
            self._kind(),
            {
                "parameters": self.params,
                "regime": self.regime.replace("_", " "),
                "settled": self.settled,
                "symmetric": self.symmetric,
                "K2/K1": m.kinetic_ratio if moves else None,
                "max|x1|": m.max_abs_x1 if moves else None,
                "rms x1": m.rms_x1 if moves else None,
                "spells of sticking a period": self.sticks,
                "multipliers": None if self.multipliers is None else self.multipliers.tolist(),
                "Lyapunov exponent": f"{self.lyapunov:.3g} ± {self.lyapunov_error:.1g}" if chaos else None,
                "periods": f"{self.transient:g} before the recording, {self.recorded:g} recorded",
                "watched": f"{self.watched:g} periods" if self.watched else None,
                "reason": self.reason or None,
            },
        )
