"""The map from just before one impact to just before the next, and its Jacobian in saltation form.

Coordinates are (v1, v2, x2, t) of the paper's maps P1–P4 (eqs. (15), (16)), x1 following from ``x1 = x2 + side``. The
derivation is in docs/dynamics.md, "Jacobian of an impact map"; it replaces the paper's appendix, whose print is wrong.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Numbers, Parameters, Whole, stated
from vines.dynamics._constants import oscillator
from vines.dynamics._flight import decay, derivatives, phasors, turn
from vines.dynamics._impact_law import after_impact_kernel, impact_law_kernel
from vines.dynamics._sincos import sincos
from vines.errors import StateError
from vines.kernels import entry_njit, new_matrix, zero_matrix
from vines.model import Params

__all__ = ["jacobian", "jacobian_kernel"]

GAP_TOLERANCE = 1e-6
"""How far the gap may be from the named wall at either impact before the arguments are taken to be wrong."""


@entry_njit
def jacobian_kernel(mu, A, Omega, r, lam, x1, v1, v2, phase, tau):
    """Return (J, x1, v1, v2): the 4x4 Jacobian over a flight of length tau, and the oscillator and ball at its end.

    The arguments x1, v1, v2, phase are those just before the first impact; the results those just before the second.
    """
    o = oscillator(1.0, A, Omega, lam)
    law = impact_law_kernel(mu, r)
    v1p, v2p = after_impact_kernel(law, v1, v2)
    ur, ui, gr, gi = phasors(o, Omega, x1, v1p, phase)
    _, _, a1p, _, _ = derivatives(o, Omega, ur, ui, gr, gi)
    ur, ui, gr, gi = turn(o, Omega, ur, ui, gr, gi, tau)
    x1n, v1n, a1n, _, _ = derivatives(o, Omega, ur, ui, gr, gi)

    # Columns of [R E, -f+] in the coordinates (x1, v1, x2, v2).
    start = zero_matrix(4, 4)
    start[0, 2] = 1.0
    start[2, 2] = 1.0
    start[1, 0], start[3, 0] = after_impact_kernel(law, 1.0, 0.0)
    start[1, 1], start[3, 1] = after_impact_kernel(law, 0.0, 1.0)
    start[0, 3] = -v1p
    start[1, 3] = -a1p
    start[2, 3] = -v2p

    size = decay(o.half * tau)
    sine, cosine = sincos(o.gamma * tau)
    sine *= size * o.inverse
    cosine *= size
    grown = new_matrix(4, 4)
    for j in range(4):
        grown[0, j] = (cosine + o.half * sine) * start[0, j] + sine * start[1, j]
        grown[1, j] = -sine * start[0, j] + (cosine - o.half * sine) * start[1, j]
        grown[2, j] = start[2, j] + tau * start[3, j]
        grown[3, j] = start[3, j]

    J = new_matrix(4, 4)
    closing = v1n - v2p
    for j in range(4):
        shift = (grown[0, j] - grown[2, j]) / closing
        J[0, j] = grown[1, j] - a1n * shift
        J[1, j] = grown[3, j]
        J[2, j] = grown[2, j] - v2p * shift
        J[3, j] = -shift
    return J, x1n, v1n, v2p


@stated(
    p=Parameters(any_system=False),
    side=Whole(least=-1, most=1),
    side_next=Whole(least=-1, most=1),
    before=Numbers(Number(least=-1e6, most=1e6), least=4, most=4),
    phase=Number(least=-1e12, most=1e12),
    tau=Number(above=0, most=1e6),
)
def jacobian(
    p: Params,
    side: int,
    side_next: int,
    before: Sequence[float],
    phase: float,
    tau: float,
) -> npt.NDArray[np.float64]:
    """Return the Jacobian of the map from just before impact k-1 to just before impact k.

    Parameters
    ----------
    p : Params
        Dimensionless parameters.
    side, side_next : int
        Walls of the two impacts, +1 for the left end, -1 for the right end.
    before : sequence of four floats
        x1, v1, x2, v2 just before impact k-1.
    phase : float
        Phase of the forcing at impact k-1 [rad].
    tau : float
        Time of flight between the two impacts, > 0 (dimensionless).

    Returns
    -------
    ndarray, shape (4, 4)
        Derivatives of (v1, v2, x2, t) at k (rows) by the same at k-1 (columns). Its determinant is
        ``r**2 (w'_{k-1}/w'_k) exp(-lam tau)`` with w' before the impacts.

    Raises
    ------
    StateError
        If the ball is not on `side` at the start or not on `side_next` after `tau`.

    Notes
    -----
    Derived in docs/dynamics.md, "Jacobian of an impact map"; it stands for the paper's (35)–(39) and A.2–A.10.

    Examples
    --------
    >>> from vines.model import Params
    >>> p = Params(mu=0.1, A=0.3, Omega=1.2)
    >>> tau = 2.3409392834070411
    >>> J = jacobian(p, 1, -1, (0.3, 0.3, -0.7, -0.8), 0.4, tau)
    >>> print(f"{np.linalg.det(J):.6f}")
    -0.425859
    >>> jacobian(p, 1, 1, (0.3, 0.3, -0.7, -0.8), 0.4, tau)
    Traceback (most recent call last):
    vines.errors.StateError: after tau = 2.34093928 the gap x1 - x2 is -1, not side_next = 1; give the time to impact
    """
    x1, v1, x2, v2 = (float(value) for value in before)
    if abs(x1 - x2 - side) > GAP_TOLERANCE:
        raise StateError(f"before impact the gap x1 - x2 is {x1 - x2:.9g}, not side = {side}; give a state on the wall")
    J, x1n, _, v2n = jacobian_kernel(p.mu, p.A, p.Omega, p.r, p.lam, x1, v1, v2, float(phase), float(tau))
    gap = x1n - (x2 + v2n * tau)
    if abs(gap - side_next) > GAP_TOLERANCE:
        raise StateError(
            f"after tau = {tau:.9g} the gap x1 - x2 is {gap:.9g}, not side_next = {side_next}; give the time to impact"
        )
    return J
