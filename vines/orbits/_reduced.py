"""The leading-order multiple-scales approximation of the symmetric 1:1 response near Omega = 1.

For mu, lam, A and Omega - 1 small of one order the oscillator swings harmonically with an amplitude and a phase that
change slowly, while the ball follows on a slow invariant manifold. Derived from the model in docs/reduced.md. The paper
compares its exact maps with reductions of this kind (section 1) but does not show where they may be trusted.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.domains import Number, Parameters, stated
from vines.dynamics.kernels import impact_law, reversing
from vines.errors import ParameterError
from vines.model import Params

__all__ = ["Reduced", "manifold_amplitude", "manifold_range", "reduced_orbits", "reduced_range"]

Complexes = npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Reduced:
    """A symmetric 1:1 response as the reduction sees it; all values are dimensionless.

    Attributes
    ----------
    params : Params
    ball_speed : float
        Speed V of the ball between impacts.
    amplitude : float
        Amplitude Z of the oscillator, on the slow invariant manifold.
    phase : float
        Phase of the forcing at the impact on L [rad], in [0, 2 pi).
    fast_multipliers : (2,) complex array
        Multipliers over half a period of the ball's motion while the oscillator keeps its amplitude and phase; they
        approximate two of `Orbit.half_multipliers`.
    slow_eigenvalues : (2,) complex array
        Eigenvalues, per unit time, of amplitude and phase on the manifold.
    min_clearance : float
        Least distance of a turning point of w to the wall it points at, 2 if no flight turns.
    """

    params: Params
    ball_speed: float
    amplitude: float
    phase: float
    fast_multipliers: Complexes
    slow_eigenvalues: Complexes
    min_clearance: float

    @property
    def w_dot(self) -> float:
        """Relative velocity w' = 2 V/(1 + r) just before the impact on L."""
        return (1 + restitution(self.params.r)) * self.ball_speed

    @property
    def max_abs_x1(self) -> float:
        """Largest |x1|, the amplitude Z: the kicks of the ball are of higher order."""
        return self.amplitude

    @property
    def kinetic_ratio(self) -> float:
        """K2/K1 = mu V² / (Z²/2), by (11) of the paper at leading order."""
        return 2 * self.params.mu * (self.ball_speed / self.amplitude) ** 2

    @property
    def fast_stable(self) -> bool:
        """Whether the ball's motion returns to the manifold."""
        return bool(np.all(np.abs(self.fast_multipliers) < 1))

    @property
    def slow_stable(self) -> bool:
        """Whether amplitude and phase return to their fixed point on the manifold."""
        return bool(np.all(self.slow_eigenvalues.real < 0))

    @property
    def stable(self) -> bool:
        """Whether the reduction calls the response stable: both fast and slow."""
        return self.fast_stable and self.slow_stable

    @property
    def admissible(self) -> bool:
        """Whether |w| < 1 between the impacts, at leading order."""
        return self.min_clearance > 0

    def __repr__(self) -> str:
        state = "stable" if self.stable else "unstable"
        return f"<Reduced 1:1, {state}, max|x1| = {self.amplitude:.6g}, V = {self.ball_speed:.6g} at {self.params}>"


def restitution(r: float) -> float:
    """Return kappa = (1 - r)/(1 + r), the velocity of the oscillator at the impact on L in units of V."""
    return reversing(impact_law(0.0, r))


def _state(V: float, r: float) -> complex:
    """Return u(V) = a e^{i phase}: x1 = Re u and x1' = -Im u at the impact on L."""
    return complex(1 - math.pi * V / 2, -restitution(r) * V)


@stated(ParameterError, V=Number(least=-1e6, most=1e6), r=Number(least=0, most=1))
def manifold_amplitude(V: float, r: float) -> float:
    """Return the amplitude Z of the oscillator under which the ball moves with speed V: the slow invariant manifold.

    Z² = (1 - pi V/2)² + kappa² V², kappa = (1 - r)/(1 + r).

    Examples
    --------
    >>> print(f"{manifold_amplitude(1.0, 0.65):.6f}")
    0.608937
    """
    return abs(_state(V, r))


@stated(ParameterError, r=Number(least=0, most=1))
def manifold_range(r: float) -> tuple[float, float]:
    """Return the speeds V between which the ball's 1:1 motion is stable on the slow invariant manifold.

    The lower one is the fold of the manifold, the upper one the loss of symmetry, 2 pi/(pi² - 4) whatever r.

    Examples
    --------
    >>> print("{:.6f} {:.6f}".format(*manifold_range(0.65)))
    0.625218 1.070461
    """
    return (math.pi / 2) / (math.pi**2 / 4 + restitution(r) ** 2), 2 * math.pi / (math.pi**2 - 4)


def _drive(V: float, p: Params) -> complex:
    """Return G(V), whose modulus equals A at a fixed point: the pull of detuning, damping and ball on the amplitude."""
    return complex(2 * (p.Omega - 1), -p.lam) * _state(V, p.r) - 4 * p.mu * V / math.pi


@stated(ParameterError, p=Parameters(any_system=False))
def reduced_range(p: Params) -> tuple[float, float]:
    """Return the amplitudes A at which the ends of `manifold_range` are reached; the A of the argument does not matter.

    Where the response grows with A the 1:1 response is stable between them: below it leaves the fold of the manifold
    (in the exact system a Neimark-Sacker point), above it loses its symmetry.

    Examples
    --------
    >>> print("{:.5f} {:.5f}".format(*reduced_range(Params(mu=0.01, A=0.02))))
    0.00955 0.01828
    """
    low, high = (abs(_drive(V, p)) for V in manifold_range(p.r))
    return low, high


@stated(ParameterError, p=Parameters(any_system=False))
def reduced_orbits(p: Params) -> list[Reduced]:
    """Return the symmetric 1:1 responses of the reduction, the one of highest impact speed first.

    Parameters
    ----------
    p : Params
        The reduction is meant for mu, A, lam and |Omega - 1| small of one order.

    Returns
    -------
    list of Reduced
        None, one or two. Only the first can be stable.

    Notes
    -----
    Closed form, derived in docs/reduced.md.

    Examples
    --------
    >>> [response] = reduced_orbits(Params(mu=0.01, A=0.017))
    >>> print(f"{response.max_abs_x1:.4f} {response.ball_speed:.4f}", response.stable, response.admissible)
    0.6273 1.0119 True True
    """
    constant, change = _drive(0.0, p), _drive(1.0, p) - _drive(0.0, p)
    # |constant + change V|² = A², a quadratic in V; the root that may cancel comes from the product of both.
    square = abs(change) ** 2
    half = -(constant.conjugate() * change).real
    rest = abs(constant) ** 2 - p.A**2
    discriminant = half**2 - square * rest
    if square == 0 or discriminant < 0:
        return []
    outer = half + math.copysign(math.sqrt(discriminant), half)
    roots = {outer / square, rest / outer if outer else 0.0}
    return [_response(V, p) for V in sorted((V for V in roots if V > 0), reverse=True)]


def _response(V: float, p: Params) -> Reduced:
    u = _state(V, p.r)
    return Reduced(
        params=p,
        ball_speed=V,
        amplitude=abs(u),
        # i A e^{i phase} = G
        phase=cmath.phase(-1j * _drive(V, p)) % (2 * math.pi),
        fast_multipliers=_fast_multipliers(V, p.r),
        slow_eigenvalues=_slow_eigenvalues(V, p),
        min_clearance=_clearance(V, u),
    )


def _fast_multipliers(V: float, r: float) -> Complexes:
    # The law of impact at mu = 0 twice, with the flights between: its trace, in closed form.
    trace = 2 * r + (1 + r) ** 2 * (math.pi / (2 * V) - math.pi**2 / 4)
    return _eigenvalues(trace, r**2)


def _slow_eigenvalues(V: float, p: Params) -> Complexes:
    u, drive = _state(V, p.r), _drive(V, p)
    u_slope = _state(1.0, p.r) - _state(0.0, p.r)
    slope = _drive(1.0, p) - _drive(0.0, p)
    steepness = 2 * (u_slope.conjugate() * u).real  # d|u|²/dV, zero at the fold of the manifold
    if steepness == 0:
        return np.full(2, complex(math.nan, math.nan))
    trace = -p.lam - 8 * p.mu * restitution(p.r) * V / (math.pi * steepness)
    return _eigenvalues(trace, (slope.conjugate() * drive).real / (2 * steepness))


def _eigenvalues(trace: float, determinant: float) -> Complexes:
    """Return the eigenvalues of a real 2x2 matrix, that of larger modulus first."""
    root = cmath.sqrt(trace**2 / 4 - determinant)
    pair = np.array([trace / 2 + root, trace / 2 - root])
    return pair[np.argsort(-np.abs(pair), kind="stable")]


def _clearance(V: float, u: complex) -> float:
    """Return the least distance to their walls of the turning points of w = Re[u e^{i s}] + pi V/2 - V s on (0, pi)."""
    Z = abs(u)
    if Z <= V:  # the ball outruns the oscillator all the way
        return 2.0
    shift = cmath.phase(1j * u)
    least = 2.0
    for turn in (math.acos(V / Z), -math.acos(V / Z)):
        s = (turn - shift) % (2 * math.pi)
        if not 0 < s < math.pi:
            continue
        w = (u * cmath.exp(1j * s)).real + math.pi * V / 2 - V * s
        bend = -(u * cmath.exp(1j * s)).real
        least = min(least, 1 + w if bend > 0 else 1 - w)
    return least
