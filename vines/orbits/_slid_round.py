"""A run of a ball that slides over the contacts of a word, what does not close, and the slopes of that."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.friction import FrictionConstants
from vines.dynamics.kernels import (
    accelerations,
    after_impact,
    carry_basis,
    constants,
    open_window,
    room_of,
    run_window,
    set_state,
    tangent_product,
)
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import EVENTS_PER_PERIOD
from vines.kernels import linked_njit, new_matrix, new_vector, njit
from vines.model import Word
from vines.orbits._equations import closing_kernel, closing_unit, prepared

__all__ = ["SlidRound", "slides"]

Floats = npt.NDArray[np.float64]


@prepared.register(FrictionConstants)
@njit
def _prepared(c):
    return c


@closing_unit.register(FrictionConstants)
@njit
def _closing_unit(c):
    return 1.0, 1.0


@closing_kernel.register(FrictionConstants)
@linked_njit
def _closing(c, duration, side, t):
    N = t.size
    return False, new_vector(N), new_matrix(N, N), new_matrix(N, 4)


def slides(p: Any) -> bool:
    """Say whether the ball of a system slides with friction."""
    return isinstance(constants(p), FrictionConstants)


class SlidRound:
    """A run from an impact on, over so many contacts of a word.

    Attributes
    ----------
    rows : ndarray
        Its events from that impact to the last contact, both included; empty if the contacts are others.
    places : list of int
        Rows of the contacts.
    """

    def __init__(self, word: Word, p: Any, z: Floats, contacts: int) -> None:
        self.word, self.p, self.begun = word, p, z
        self.c = constants(p)
        self.rows, self.places = np.empty((0, col.ROW)), []
        x1, v1, v2, phase = z.tolist()
        side = word.sides[0]
        if not (np.isfinite(z).all() and side * (v1 - v2) > 0 and np.abs(z).max() < 1e6):
            return
        after1, after2 = after_impact(room_of(p).law(p, 1), v1, v2)
        state = np.zeros(col.STATE)
        set_state(state, x1, after1, x1 - side, after2, phase % (2 * math.pi), 0.0)
        rows = np.empty((64, col.ROW))
        # A little longer, so that the contact at the end is among the events.
        stop = (word.p * contacts / len(word) + 0.5) * p.period
        rows, count, code = run_window(self.c, state, stop, EVENTS_PER_PERIOD, rows, open_window(self.c, state, rows))
        wanted = [*word.sides[1:], *word.sides][:contacts]
        places = [0]
        for i in range(1, count if code == col.COMPLETE else 0):
            kind = rows[i, col.KIND]
            if kind == col.STICK:
                return
            if kind in (col.IMPACT, col.STOP):
                if (rows[i, col.SIDE] if kind == col.IMPACT else 0.0) != wanted[len(places) - 1]:
                    return
                places.append(i)
                if len(places) > contacts:
                    self.rows, self.places = rows[: i + 1].copy(), places
                    return

    def closing(self, half: bool) -> Floats:
        """Return by how much x1, v1, v2 and the time at the return of the first contact, or of its image, are off."""
        x1, v1, v2, t = self.end
        sign, lasts = (-1.0, 0.5) if half else (1.0, 1.0)
        z = self.begun
        return np.array([sign * x1 - z[0], sign * v1 - z[1], sign * v2 - z[2], t - lasts * self.word.p * self.p.period])

    @property
    def tangent(self) -> Floats:
        """The tangent map from just after the first contact to just after the last, at fixed times."""
        return tangent_product(self.c, self.rows, 0, self.places[-1])

    def slopes(self, half: bool) -> Floats:
        """Return the derivatives of `closing` in x1, v1, v2 and the phase of the first impact, shape (4, 4)."""
        if not self.places:
            return np.full((4, 4), math.nan)
        p, rows, last = self.p, self.rows, self.places[-1]
        law = room_of(p).law(p, 1)
        first = rows[0]
        a1, a2 = accelerations(self.c, first[col.X1], first[col.A_V1], first[col.A_V2], first[col.PHASE])
        Y = np.zeros((4, 4))
        Y[0, 0] = Y[2, 0] = 1.0
        for j, one in ((1, (1.0, 0.0)), (2, (0.0, 1.0))):
            Y[1, j], Y[3, j] = after_impact(law, *one)
        # An impact later by dt was before on its own motion.
        Y[:, 3] = -np.array([first[col.A_V1], a1, first[col.A_V2], a2]) / p.Omega
        Y = tangent_product(self.c, rows, 0, last - 1) @ Y
        carry_basis(self.c, rows[last - 1], rows[last, col.TAU], Y)
        end = rows[last]
        late = -(Y[0] - Y[2]) / (end[col.V1] - end[col.V2])
        b1, b2 = accelerations(self.c, end[col.X1], end[col.V1], end[col.V2], end[col.PHASE])
        sign = -1.0 if half else 1.0
        slope = np.stack([
            sign * (Y[0] + end[col.V1] * late), sign * (Y[1] + b1 * late), sign * (Y[3] + b2 * late), late,
        ])  # fmt: skip
        return slope - np.diag([1.0, 1.0, 1.0, 1.0 / p.Omega])

    @property
    def end(self) -> Floats:
        """x1, v1, v2 and the time at the last contact; nan where the contacts are others."""
        return self.rows[-1, [col.X1, col.V1, col.V2, col.TIME]] if self.places else np.full(4, math.nan)
