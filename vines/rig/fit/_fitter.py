"""What all fits of a run share, and how an acceleration alone is fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.rig.fit._bins import Bins
from vines.rig.fit._jump_model import JumpModel, noise_of
from vines.rig.fit._jumps import JumpFit
from vines.rig.fit._signal import Forced, Terms
from vines.rig.fit._slide import Push, push, slide
from vines.rig.fit._train import Train

__all__ = ["KEEP", "LEAST", "Fitter"]

Floats = npt.NDArray[np.float64]

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
    model : JumpModel
        Of the channel.
    driven : complex, optional
        First harmonic of the forced response that the base asks for [m].
    b : float
        Half length of the cavity [m].
    friction : float
        Acceleration of the oscillator by the ball's friction, mu times the ball's deceleration [m/s^2].
    u_natural : tuple of float
        Relative standard uncertainties of omega0 and lam.
    """

    model: JumpModel
    driven: complex | None = None
    b: float = 0.0
    friction: float = 0.0
    u_natural: tuple[float, float] = (1e-5, 1e-3)

    @property
    def bins(self) -> Bins:
        """What is fitted."""
        return self.model.bins

    def on(self, bins: Bins) -> Fitter:
        """Return the fitter of other samples of the channel."""
        return replace(self, model=replace(self.model, bins=bins))

    def fit(self, train: Train, draws: int = 8, pushed: Push | None = None, extra: Terms | None = None) -> JumpFit:
        """Fit the channel at given impacts, twice where flights that hold another one spoil the first fit.

        Parameters
        ----------
        train, draws, pushed
            As of `JumpModel.fit`.
        extra : tuple of ndarray, optional
            As of `JumpModel`; for a displacement.
        """
        held = replace(self.model, forced=self._held())
        if self.model.order == 0:
            model = replace(self.model, extra=extra)
            free = model.fit(train, pushed=pushed, draws=draws)
            if free.residual < _CLEAN * free.noise:
                return free
            fair = replace(held, extra=extra).fit(train, pushed=pushed, draws=0).fair
            if np.array_equal(fair, free.fair):
                return free
            again = model.fit(train, pushed=pushed, fair=fair, draws=draws)
            return again if again.residual < free.residual else free
        # The flights give the jumps; areas of pulses only hold those that have no samples beside them.
        expected = (train.dv, np.abs(train.dv) + LEAST)
        waves, u_waves = _wander(self.bins)
        first = replace(held, extra=(waves, u_waves)).fit(train, expected=expected, pushed=pushed, draws=0)
        sideways = self.model.omega * first.motion.at(self.bins.t, 1)
        more = (np.vstack([sideways, waves]), np.append(_U_SIDEWAYS, u_waves))
        model = replace(self.model, extra=more)
        return model.fit(train, expected=expected, pushed=pushed, fair=first.fair, draws=draws)

    def _held(self) -> Forced | None:
        """Return the harmonics with the first one as the base asks for it, firmly.

        A forced response and a train of equal jumps are nearly the same motion, so that a few flights with an impact
        that is missing turn one into the other: with 3 % of them missing all jumps can come out as nothing. With the
        forced response held, it is seen which flights these are. In the fit that follows it is free, so that base and
        oscillator can be compared.
        """
        if self.driven is None or self.model.forced is None:
            return self.model.forced
        c, u = self.model.forced
        return np.append(self.driven, c), np.append(_HELD * abs(self.driven), u)

    def rubbed(self, fit: JumpFit) -> Push | None:
        """Return what the friction of a ball that flies between the impacts of a fit adds to the displacement."""
        times = fit.motion.starts[1:]
        if len(times) < 2:
            return None
        found = slide(fit.motion, fit.jumps.x + np.sign(fit.jumps.dv) * self.b)
        return push(found, times, self.bins.t, self.model.s, self._moved(), self.model.order)

    def fit_rubbed(self, train: Train, draws: int = 8) -> tuple[JumpFit, Push | None]:
        """Fit with the ball's friction, if its size matters beside the noise, and say what that adds.

        Friction that turns in a slow flight bends it by micrometres: enough to say that a pulse came late.
        """
        if self.model.order == 2 or self._moved() < _RUBS * noise_of(self.bins):
            return self.fit(train, draws), None
        pushed = self.rubbed(self.fit(train, 0))
        return self.fit(train, draws, pushed), pushed

    def _moved(self) -> float:
        """Return the static displacement by friction [m]."""
        return self.friction / abs(self.model.s) ** 2


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
