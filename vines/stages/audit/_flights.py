"""Free flights in closed form for many impacts at once: where they land, and the integrals over them by quadrature.

Written apart from `vines.dynamics`, with other means (complex amplitudes in numpy, Gauss-Legendre nodes where the
kernels have closed forms), so that an error there does not confirm itself here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from vines.model import PARAMETER_NAMES
from vines.stages.audit._rows import Floats, Rows

__all__ = ["Flights", "Sums"]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_BLOCK = 2**15
"""Panels that are worked on at a time: about 30 MB."""
_NEWTON = 4


class Sums(NamedTuple):
    """Integrals over each flight and its extremes, shape (n,).

    `v1_square`, `v2_square`, `x1_square` are integrals of the squares; `base_work` and `damper_loss` are energies in
    M b² omega0²; `largest_x1` and `largest_gap` are the largest |x1| and |w|, the latter at the nodes only.
    """

    v1_square: Floats
    v2_square: Floats
    x1_square: Floats
    base_work: Floats
    damper_loss: Floats
    largest_x1: Floats
    largest_gap: Floats


@dataclass(frozen=True)
class Flights:
    """Flights, each from the state just before an impact to the next impact; all arrays of shape (n,).

    Attributes
    ----------
    mu, A, Omega, r, lam : array
        Parameters.
    x1, v1, x2, v2, phase : array
        State just before the impact, and the forcing phase [rad].
    dt : array
        Duration of the flight.
    """

    mu: Floats
    A: Floats
    Omega: Floats
    r: Floats
    lam: Floats
    x1: Floats
    v1: Floats
    x2: Floats
    v2: Floats
    phase: Floats
    dt: Floats

    def __len__(self) -> int:
        return len(self.dt)

    @classmethod
    def of(cls, parameters: Rows, each: npt.NDArray[np.int64] | slice, state: Mapping[str, Floats]) -> Flights:
        """Return flights with the parameters of some rows.

        Parameters
        ----------
        parameters : Rows
            A table with the parameters.
        each : array of int or slice
            Its row for each flight.
        state : mapping
            The other attributes.
        """
        return cls(**{name: parameters[name][each] for name in PARAMETER_NAMES}, **state)

    def after(self) -> tuple[Floats, Floats]:
        """Return v1 and v2 just after the impacts (paper, eq. (12))."""
        mu, r = self.mu, self.r
        v1 = ((1 - r * mu) * self.v1 + mu * (1 + r) * self.v2) / (1 + mu)
        v2 = ((1 + r) * self.v1 + (mu - r) * self.v2) / (1 + mu)
        return v1, v2

    def land(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return x1, v1, x2, v2 at the end of each flight."""
        z, q, s, v2 = self._phasors()
        free, forced = z * np.exp(s * self.dt), q * np.exp(1j * self.Omega * self.dt)
        x1, v1 = (free + forced).real, (s * free + 1j * self.Omega * forced).real
        return x1, v1, self.x2 + v2 * self.dt, v2

    def sums(self) -> Sums:
        """Return the integrals over each flight."""
        # Over half a period of the faster part the nodes integrate the squares to rounding.
        panels = np.maximum(np.ceil(self.dt * np.maximum(self.Omega, 1.0) / np.pi), 1.0).astype(np.int64)
        parts = [Sums(*(np.empty(0) for _ in Sums._fields))]
        start = 0
        ends = np.cumsum(panels)
        while start < len(self):
            done = 0 if start == 0 else ends[start - 1]
            stop = max(int(np.searchsorted(ends, done + _BLOCK, side="right")), start + 1)
            part = slice(start, stop)
            parts.append(self.take(part)._sums(panels[part]))
            start = stop
        return Sums(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))

    def take(self, places: npt.NDArray[np.int64] | slice) -> Flights:
        """Return some of the flights."""
        return Flights(**{name: getattr(self, name)[places] for name in self.__dataclass_fields__})

    def _phasors(
        self,
    ) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128], npt.NDArray[np.complex128], Floats]:
        """Return z, q, s of x1 = Re[z e^{s tau} + q e^{i Omega tau}] after the impact, and the ball's velocity."""
        v1, v2 = self.after()
        half = self.lam / 2
        gamma = np.sqrt(1 - half**2)
        s = -half + 1j * gamma
        response = self.A * (self.lam * self.Omega - 1j) / (1 - self.Omega**2 + 1j * self.lam * self.Omega)
        q = response * np.exp(1j * self.phase)
        real = self.x1 - q.real
        imaginary = -(v1 + self.Omega * q.imag + half * real) / gamma
        return real + 1j * imaginary, q, s, v2

    def _sums(self, panels: npt.NDArray[np.int64]) -> Sums:
        z, q, s, ball = self._phasors()
        z, q, s, v2 = z[:, None], q[:, None], s[:, None], ball[:, None]
        which = np.repeat(np.arange(len(self)), panels)
        first = np.concatenate([[0], np.cumsum(panels)[:-1]])
        width = (self.dt / panels)[which]
        begin = (np.arange(len(which)) - first[which]) * width
        tau = begin[:, None] + width[:, None] * (1 + _NODES) / 2
        Omega, lam, A, phase, x2 = (each[which, None] for each in (self.Omega, self.lam, self.A, self.phase, self.x2))

        def motion(tau: Floats) -> tuple[Floats, Floats, Floats]:
            free, forced = z[which] * np.exp(s[which] * tau), q[which] * np.exp(1j * Omega * tau)
            angle = phase + Omega * tau
            x, v = (free + forced).real, (s[which] * free + 1j * Omega * forced).real
            return x, v, A * np.sin(angle) + lam * Omega * A * np.cos(angle) - lam * v - x

        x, v, a = motion(tau)
        shaken = A * Omega * np.cos(phase + Omega * tau)

        def integral(values: Floats) -> Floats:
            return np.add.reduceat((values @ _WEIGHTS) * width / 2, first)

        # the largest |x1| of a panel: from its best node by Newton's method to where v1 = 0, inside the panel
        best = np.take_along_axis(tau, np.abs(x).argmax(axis=1)[:, None], axis=1)
        for _ in range(_NEWTON):
            _, speed, bend = motion(best)
            step = np.divide(speed, bend, out=np.zeros_like(speed), where=bend != 0)
            best = np.clip(best - step, begin[:, None], (begin + width)[:, None])
        peak = np.maximum(np.abs(motion(best)[0])[:, 0], np.abs(x).max(axis=1))
        peak = np.maximum(np.maximum.reduceat(peak, first), np.abs(self.x1))
        gap = np.abs(x - x2 - v2[which] * tau).max(axis=1)
        return Sums(
            v1_square=integral(v * v),
            v2_square=ball**2 * self.dt,
            x1_square=integral(x * x),
            base_work=integral(shaken * a),
            damper_loss=integral(lam * (v - shaken) ** 2),
            largest_x1=peak,
            largest_gap=np.maximum.reduceat(gap, first),
        )
