"""The law of impact (paper, eq. (12)): what an impact makes of the velocities of oscillator and ball.

Momentum is kept, and the ball leaves at r times the speed at which it came. It stands here and nowhere else in the
rooms that simulate and solve; what is called `…_kernel` is for kernels, its namesake for numbers and arrays.
"""

from __future__ import annotations

from typing import NamedTuple

from vines.kernels import fused_njit, njit

__all__ = [
    "ImpactLaw",
    "after_impact",
    "after_impact_kernel",
    "impact_law",
    "impact_law_kernel",
    "reversing",
    "reversing_kernel",
]


class ImpactLaw(NamedTuple):
    """The velocities after an impact are linear in those before: what each body keeps and what the other passes to it.

    ``v1_after = keep1 v1 + pass1 v2`` and ``v2_after = pass2 v1 + keep2 v2``. ``ratio`` is the mass of the ball in
    units of the oscillator's, by which momentum is counted: the oscillator loses `ratio` times what the ball gains.
    """

    keep1: float
    pass1: float
    keep2: float
    pass2: float
    ratio: float


@njit
def impact_law_kernel(mu, r):
    """Return the `ImpactLaw` of a ball of mass mu with restitution r.

    The coefficients are rounded alike wherever they are worked out; what is done with them may be contracted.

    Examples
    --------
    >>> law = impact_law(0.01, 0.65)
    >>> print(f"{law.keep1:.4f} {law.pass1:.4f} {law.keep2:.4f} {law.pass2:.4f}")
    0.9837 0.0163 -0.6337 1.6337
    """
    mass = 1.0 + mu
    return ImpactLaw((1.0 - r * mu) / mass, mu * (1.0 + r) / mass, (mu - r) / mass, (1.0 + r) / mass, mu)


@fused_njit
def after_impact_kernel(law, v1, v2):
    """Return the velocities of oscillator and ball just after an impact, from those just before.

    Being linear, it carries small differences of them just so.

    Examples
    --------
    >>> v1, v2 = after_impact(impact_law(0.01, 0.65), 0.2, -1.0)
    >>> print(f"{v1 + 0.01 * v2:.2f} {v2 - v1:.2f}")
    0.19 0.78
    """
    return law.keep1 * v1 + law.pass1 * v2, law.pass2 * v1 + law.keep2 * v2


@njit
def reversing_kernel(law):
    """Return the velocity of the oscillator at which an impact just turns round a ball that comes at speed 1.

    ``pass2 v1 - keep2 = 1``: kappa of the symmetric 1:1 orbits, (1 + 2 mu - r)/(1 + r).

    Examples
    --------
    >>> print(f"{reversing(impact_law(0.01, 0.65)):.6f}")
    0.224242
    """
    return (1.0 + law.keep2) / law.pass2


impact_law = impact_law_kernel.py_func  # pyright: ignore[reportFunctionMemberAccess]
after_impact = after_impact_kernel.py_func  # pyright: ignore[reportFunctionMemberAccess]
reversing = reversing_kernel.py_func  # pyright: ignore[reportFunctionMemberAccess]
