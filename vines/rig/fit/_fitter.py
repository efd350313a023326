"""What all fits of a run share, and how an acceleration alone is fitted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.rig.fit._bins import Bins
from vines.rig.fit._jumps import JumpFit, fit_jumps, noise_of
from vines.rig.fit._slide import Push, push, slide

__all__ = ["KEEP", "LEAST", "Fitter"]

Floats = npt.NDArray[np.float64]
Forced = tuple[npt.NDArray[np.complex128], Floats]

KEEP = 5.0

LEAST = 2e-4
"""No smaller jump is believed [m/s]."""

_RUBS = 0.2
"""Least static displacement by friction that matters while impacts are sought, relative to the noise of a mean."""

_U_SIDEWAYS = 3e-3
"""Sway across the axis, relative to the motion: a tenth of it, seen by a cross-axis sensitivity of some per cent."""

_HELD = 1e-3
"""How firmly the base holds the forced response where it holds it, relative to it."""

_CLEAN = 1.2
"""Most that a fit leaves, relative to the noise, before it is asked whether flights with a missing impact spoil it."""

_WAVES = 20

_U_WANDER = 0.05
"""Wander of the offset of an accelerometer [m/s^2]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fitter:
    """What all fits of a run share.

    Attributes
    ----------
    bins : Bins
        Of the channel.
    s, omega : complex, float
        Of the free oscillation and of the forcing [1/s].
    order : {0, 2}
        Derivative of x1 that the channel measures.
    forced : tuple of ndarray or None
        As of `fit_jumps`.
    driven : complex, optional
        First harmonic of the forced response that the base asks for [m].
    b : float
        Half length of the cavity [m].
    friction : float
        Acceleration of the oscillator by the ball's friction, mu times the ball's deceleration [m/s^2].
    u_natural : tuple of float
        Relative standard uncertainties of omega0 and lam.
    """

    bins: Bins
    s: complex
    omega: float
    order: int
    forced: Forced | None
    driven: complex | None = None
    b: float = 0.0
    friction: float = 0.0
    u_natural: tuple[float, float] = (1e-5, 1e-3)

    def fit(
        self,
        times: Floats,
        u: Floats,
        dv: Floats,
        draws: int = 8,
        pushed: Push | None = None,
        extra: tuple[Floats, Floats] | None = None,
    ) -> JumpFit:
        def once(forced: Forced | None, more: tuple[Floats, Floats] | None, draws: int, **given: Any) -> JumpFit:
            return fit_jumps(
                self.bins, self.s, self.omega, times, u, dv, order=self.order, draws=draws, forced=forced,
                pushed=pushed, extra=more, **given,
            )  # fmt: skip

        if self.order == 0:
            free = once(self.forced, extra, draws)
            if free.residual < _CLEAN * free.noise:
                return free
            held = once(self._held(), extra, 0)
            if np.array_equal(held.fair, free.fair):
                return free
            again = once(self.forced, extra, draws, fair=held.fair)
            return again if again.residual < free.residual else free
        # The flights give the jumps; areas of pulses only hold those that have no samples beside them.
        expected = (dv, np.abs(dv) + LEAST)
        waves, u_waves = _wander(self.bins)
        first = once(self._held(), (waves, u_waves), 0, expected=expected)
        sideways = self.omega * first.motion.at(self.bins.t, 1)
        more = (np.vstack([sideways, waves]), np.append(_U_SIDEWAYS, u_waves))
        return once(self.forced, more, draws, expected=expected, fair=first.fair)

    def _held(self) -> Forced | None:
        """Return the harmonics with the first one as the base asks for it, firmly.

        A forced response and a train of equal jumps are nearly the same motion, so that a few flights with an impact
        that is missing turn one into the other: with 3 % of them missing all jumps can come out as nothing. With the
        forced response held, it is seen which flights these are. In the fit that follows it is free, so that base and
        oscillator can be compared.
        """
        if self.driven is None or self.forced is None:
            return self.forced
        (c, u) = self.forced
        return np.append(self.driven, c), np.append(_HELD * abs(self.driven), u)

    def rubbed(self, fit: JumpFit, times: Floats) -> Push | None:
        """Return what the friction of a ball that flies between the impacts of a fit adds to the displacement."""
        if len(times) < 2:
            return None
        found = slide(fit.motion, fit.jumps.x + np.sign(fit.jumps.dv) * self.b)
        return push(found, times, self.bins.t, self.s, self.friction / abs(self.s) ** 2, self.order)

    def fit_rubbed(self, times: Floats, u: Floats, dv: Floats, draws: int = 8) -> tuple[JumpFit, Push | None]:
        """Fit with the ball's friction, if its size matters beside the noise, and say what that adds.

        Friction that turns in a slow flight bends it by micrometres: enough to say that a pulse came late.
        """
        if self.order == 2 or self.friction / abs(self.s) ** 2 < _RUBS * noise_of(self.bins):
            return self.fit(times, u, dv, draws), None
        pushed = self.rubbed(self.fit(times, u, dv, 0), times)
        return self.fit(times, u, dv, draws, pushed), pushed


def _wander(bins: Bins) -> tuple[Floats, Floats]:
    """Return slow waves over the record, and how large each may be: the offset of an accelerometer wanders.

    Where its high-pass is undone noise and knocks are integrated: a random walk, whose part of k half periods falls as
    1/k.
    """
    k = np.arange(1, _WAVES + 1)
    turn = np.exp(1j * np.pi * (bins.t - bins.t[0]) / (bins.t[-1] - bins.t[0]))
    waves = np.empty((_WAVES, len(turn)))
    power = np.ones_like(turn)
    for row in waves:
        power = power * turn
        row[:] = power.real
    return waves, _U_WANDER / k
