"""A run of a structure of several modes: its samples, and measures of each mode."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import _advance as col
from vines.dynamics import _totals as entry
from vines.dynamics._measures import Measures, of_the_frame
from vines.dynamics._room import constants, room_of
from vines.dynamics._trajectory import SAMPLE, Table, Trajectory
from vines.dynamics.modes._layout import DAMPER, EACH, R_MODAL, SPEED_SQUARE, STRAIN_SQUARE
from vines.dynamics.modes._samples import FIRST_MODE, sample_modes

__all__ = ["ModalMeasures", "ModesMeasures", "ModesRun", "modes_measures", "push_of"]


@dataclass(frozen=True, slots=True)
class ModalMeasures:
    """Measures of one mode over a window, in the units of `Measures`.

    Attributes
    ----------
    kinetic, potential : float
        Time averages of q'²/2 and of omega_k² (q - gamma_k e)²/2.
    damper_loss : float
        Energy lost in its damper.
    """

    kinetic: float
    potential: float
    damper_loss: float


@dataclass(frozen=True, slots=True)
class ModesMeasures(Measures):
    """Measures of a window with several modes; `kinetic_1` is that of a mass M at the cavity.

    Attributes
    ----------
    modes : tuple of ModalMeasures
    """

    modes: tuple[ModalMeasures, ...] = ()


def modes_measures(p: Any, totals: npt.NDArray[np.float64]) -> ModesMeasures:
    """Return the measures of a window from the totals that `window_totals` gives."""
    t = totals.tolist()
    duration, v1_square, v2_square = t[entry.DURATION], t[entry.V1_SQUARE], p.mu * t[entry.V2_SQUARE]
    per = 1.0 / duration if duration > 0 else math.nan
    return ModesMeasures(
        kinetic_2=0.5 * v2_square * per,
        kinetic_ratio=v2_square / v1_square if v1_square > 0 else math.nan,
        modes=tuple(
            ModalMeasures(
                kinetic=0.5 * t[SPEED_SQUARE + at] * per,
                potential=0.5 * t[STRAIN_SQUARE + at] * per,
                damper_loss=t[DAMPER + at],
            )
            for at in range(0, EACH * p.modes, EACH)
        ),
        **of_the_frame(p, t),
    )


def push_of(p: Any, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return x1'' of the structure without the ball just after rows."""
    phase = rows[:, col.PHASE]
    e, rate = p.A * np.sin(phase), p.A * p.Omega * np.cos(phase)
    found = -p.direct * p.Omega**2 * e
    for k, (omega, lam, phi, gamma) in enumerate(zip(p.omega, p.lam, p.phi, p.gamma, strict=True)):
        z, z_dot = rows[:, R_MODAL + 2 * k], rows[:, R_MODAL + 1 + 2 * k]
        found = found + phi * (omega**2 * (gamma * e - z) + lam * (gamma * rate - z_dot))
    return found


class ModesRun(Trajectory):
    """One run of a structure of several modes; see `Trajectory`.

    Samples have amplitude and velocity of each mode beside, q_1, q_dot_1, …; of their energies kinetic_1 is the sum of
    q_dot²/2 and potential that of omega² (q - gamma base)²/2.
    """

    def _push(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        # That before the merge, whose blow the dampers feel already in the rows.
        p = self.params
        impulse = -p.mu * (rows[:, col.A_V2] - rows[:, col.V2])
        return push_of(p, rows) + impulse * sum(lam * phi**2 for lam, phi in zip(p.lam, p.phi, strict=True))

    def _fill(
        self,
        t: npt.NDArray[np.float64],
        segment: npt.NDArray[np.int64],
        tau: npt.NDArray[np.float64],
        before: npt.NDArray[np.bool_],
    ) -> Table:
        p = self.params
        raw = np.empty((len(t), FIRST_MODE + 2 * p.modes))
        sample_modes(constants(p), self.rows, segment, tau, before, raw)
        own = [(f"{name}_{k}", "f8") for k in range(1, p.modes + 1) for name in ("q", "q_dot")]
        out = np.empty(len(t), dtype=[*SAMPLE.descr, *own])
        out["t"] = t
        names = ("x1", "v1", "x2", "v2", "phase", "stuck", "base_work", "damper_loss", "impact_loss")
        for k, name in enumerate((*names, *(name for name, _ in own))):
            out[name] = raw[:, k]
        out["w"] = out["x1"] - out["x2"]
        out["w_dot"] = out["v1"] - out["v2"]
        out["base"] = room_of(p).base(p, out["phase"])
        out["kinetic_1"], out["kinetic_2"], out["potential"] = room_of(p).stored(p, out)
        return out
