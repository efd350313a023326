"""What a simulation settled to."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures

__all__ = ["Attractor"]


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
        complete chatter counts as one contact.
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
        Standard errors of these measures, 0 if periodic.
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
    status: str
    reason: str
