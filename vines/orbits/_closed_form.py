"""The symmetric 1:1/pT orbits in closed form, p odd; derived in docs/orbits.md.

Everything follows from the speed V of the ball between impacts: the oscillator is the forced response plus
the antiperiodic response to kicks of -2 mu V, so that the state at the impact is linear in V and V solves one
quadratic. The paper (section 4.1) finds the same orbits by numerical root finding.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from vines.dynamics.kernels import impact_law, reversing
from vines.errors import ParameterError
from vines.model import VI_NES

__all__ = ["SymmetricFamily", "family_of", "family_where", "fold_amplitude", "fold_speed", "impact_states", "speeds"]


class SymmetricFamily(NamedTuple):
    """What the symmetric 1:1/pT orbits at given mu, Omega, r, lam share, whatever A.

    Attributes
    ----------
    half : float
        Time h = pT/2 between impacts.
    alpha, beta, kappa : float
        Coefficients of the impact state: at L, the forced response is 1 + alpha V, its derivative
        Omega beta V, and the velocity before impact kappa V.
    response : complex
        The forced response per unit of A: xp = A Re[response e^{i phase}].
    """

    half: float
    alpha: float
    beta: float
    kappa: float
    response: complex

    @property
    def stiffness(self) -> float:
        """alpha² + beta², the coefficient of V² in the quadratic."""
        return self.alpha**2 + self.beta**2

    def defect(self, V: float, A: float) -> float:
        """Return (alpha² + beta²) V² + 2 alpha V + 1 - B², which vanishes on an orbit; B = A |response|."""
        return self.stiffness * V**2 + 2 * self.alpha * V + 1 - (A * abs(self.response)) ** 2

    def slope(self, V: float) -> float:
        """Return the derivative of `defect` in V, which vanishes at the fold."""
        return 2 * (self.stiffness * V + self.alpha)


def refuse_resonance(p: Any) -> None:
    """Raise where the steady response, over which all closed forms of orbits are written, does not exist.

    Raises
    ------
    ParameterError
        At Omega = 1 without damping.
    """
    name = resonant(p)
    if name is not None:
        raise ParameterError(
            f"{name} is {p.as_dict()[name]:g} at Omega = {p.Omega:g}, where no response is steady; give {name} > 0"
        )


def resonant(p: Any) -> str | None:
    """Return the name of the damping that an oscillator driven at its own frequency lacks, None elsewhere."""
    values = p.as_dict()
    for name, lam in values.items():
        if name.partition("_")[0] != "lam":
            continue
        omega = values.get(f"omega{name.removeprefix('lam')}", 1.0)
        if math.hypot(omega**2 - p.Omega**2, lam * p.Omega) <= 1e-9:
            return name
    return None


def family_of(mu: float, Omega: float, r: float, lam: float, period: int) -> SymmetricFamily:
    """Return the coefficients of the symmetric 1:1/pT family.

    Parameters
    ----------
    mu, Omega, r, lam : float
        Parameters of the model.
    period : int
        p, odd.

    Raises
    ------
    ParameterError
        If p is not an odd positive integer, or the undamped oscillator resonates with the kicks.

    Examples
    --------
    >>> f = family_of(0.01, 1.0, 0.65, 0.0119979670, 1)
    >>> print(f"{f.alpha:.6f} {f.beta:.6f} {f.kappa:.6f}")
    -1.573979 1.275496 0.224242
    """
    if isinstance(period, bool) or not isinstance(period, int) or period < 1 or period % 2 == 0:
        raise ParameterError(f"period is {period!r}, allowed is 1, 3, 5, …: a symmetric orbit has an odd period")
    half = math.pi * period / Omega
    gamma = math.sqrt(1 - lam**2 / 4)
    s = complex(-lam / 2, gamma)
    weight = 1 + cmath.exp(s * half)
    if abs(weight) < 1e-12:
        raise ParameterError(
            f"lam is {lam:g} at Omega = {Omega:g}, where impacts and oscillator resonate; give lam > 0"
        )
    q = 1 / weight
    law = impact_law(mu, r)
    kappa = reversing(law)
    return SymmetricFamily(
        half=half,
        alpha=2 * law.ratio * q.imag / gamma - half / 2,
        beta=(kappa + 2 * law.ratio * ((s * q).imag / gamma - 1)) / Omega,
        kappa=kappa,
        response=complex(lam * Omega, -1) / complex(1 - Omega**2, lam * Omega),
    )


def family_where(values: Mapping[str, float], period: int) -> SymmetricFamily | None:
    """Return the same at parameter values by name, None where the model or its steady response does not exist.

    Examples
    --------
    >>> values = {"mu": 0.01, "A": 0.02, "Omega": 1.0, "r": 0.65}
    >>> family_where(values | {"lam": -0.1}, 1) is None, family_where(values | {"lam": 0.0}, 1) is None
    (True, True)
    """
    if not all(VI_NES.parameter(name).allowed.holds(value) for name, value in values.items()):
        return None
    try:
        return family_of(values["mu"], values["Omega"], values["r"], values["lam"], period)
    except (ParameterError, ArithmeticError):
        return None


def speeds(family: SymmetricFamily, A: float) -> tuple[float, ...]:
    """Return the speeds V > 0 of the symmetric orbits at amplitude A, the largest first: none, one or two.

    Examples
    --------
    >>> speeds(family_of(0.01, 1.0, 0.65, 0.0119979670, 1), 0.02)
    (1.1454...,)
    """
    B2 = (A * abs(family.response)) ** 2
    discriminant = B2 * family.stiffness - family.beta**2
    if discriminant < 0:
        return ()
    # The root without cancellation, and the other one from the product of the roots.
    outer = -family.alpha + math.copysign(math.sqrt(discriminant), -family.alpha)
    roots = {outer / family.stiffness, (1 - B2) / outer if outer else 0.0}
    return tuple(sorted((V for V in roots if V > 0), reverse=True))


def fold_amplitude(family: SymmetricFamily) -> float:
    """Return the least A with a symmetric orbit: a fold if alpha < 0, else the end of the family at V = 0."""
    least = abs(family.beta) / math.sqrt(family.stiffness) if family.alpha < 0 else 1.0
    return least / abs(family.response)


def fold_speed(family: SymmetricFamily) -> float:
    """Return V at the fold; negative where there is none."""
    return -family.alpha / family.stiffness


def impact_states(family: SymmetricFamily, V: float, A: float, Omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the two impacts of the symmetric orbit of speed V, L first.

    Returns
    -------
    t : (2,) float array
        Times, the first in [0, T), for a forcing of phase zero at t = 0.
    states : (2, 4) float array
        x1, v1, x2, v2 just before each impact.
    """
    forced, slope = 1 + family.alpha * V, family.beta * V
    # With b = A response, Re[b e^{i phase}] = forced and its derivative in the phase is slope.
    phase = cmath.phase(complex(forced, -slope) / (A * family.response))
    start = (phase % (2 * math.pi)) / Omega
    x1 = 1 - family.half * V / 2
    left = np.array([x1, family.kappa * V, x1 - 1, -V])
    return np.array([start, start + family.half]), np.stack([left, -left])
