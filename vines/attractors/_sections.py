"""Periodic attractors as points of a section at one forcing phase, and which states come to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._carried import names_of, sort_alike
from vines.dynamics import simulate, tangent_map

__all__ = ["NEAR", "ON", "Section", "sections_of"]

Floats = npt.NDArray[np.float64]


NEAR = 0.02
"""Distance from a periodic orbit, in units of its largest speed, below which a state that comes nearer is captured."""

ON = 1e-6
"""The same below which a settled state is on that orbit."""

FLAT = 1e4
"""Condition number of the eigenvectors beyond which distances are taken as they are."""


@dataclass(frozen=True)
class Section:
    """States of a periodic attractor, or of its mirror image, once a forcing period.

    Attributes
    ----------
    owner : int
        Number of the attractor.
    mirrored : bool
        Whether this is its mirror image (x, t) -> (-x, t + T/2).
    points : ndarray, shape (p, d)
        Coordinates of the system: x1, v1, x2, v2 of the VI-NES.
    frames : ndarray of complex, shape (p, d, d)
        Maps the difference to a point, over `scale`, to its parts along the eigenvectors of the period map: what is
        near the orbit comes nearer in these coordinates at every return, however it turns.
    scale : float
        Largest speed among the points.
    resting : tuple of (int, float)
        Of each ball that rests and is never hit, the column of its position, which may be any, and how far from the
        middle the orbit does not reach it. The frames are those of the other coordinates.
    """

    owner: int
    mirrored: bool
    points: Floats
    frames: npt.NDArray[np.complex128]
    scale: float
    resting: tuple[tuple[int, float], ...] = ()

    def distance(self, states: Floats, *, coming: bool = False) -> Floats:
        """Return how far states, shape (n, d), are from the nearest of the points, inf where that is not near.

        Where balls rest on the orbit they have to; of states that are `coming`, and not on it yet, they have to be
        where it does not reach them too.
        """
        nearest = np.full(len(states), np.inf)
        points = self.points
        there = np.ones(len(states), dtype=bool)
        if self.resting:
            for column, room in self.resting:
                there &= states[:, column + 1] == 0.0
                if coming:
                    there &= np.abs(states[:, column]) < room
            states, points = (np.delete(each, _columns(self.resting), axis=1) for each in (states, points))
        for point, frame in zip(points, self.frames, strict=True):
            away = (states - point) / self.scale
            # Eigenvectors have length 1: a difference is at most the sum of its parts.
            close = np.flatnonzero(there & (np.max(np.abs(away), axis=1) < float(len(frame)) * NEAR))
            nearest[close] = np.minimum(nearest[close], np.max(np.abs(away[close] @ frame.T), axis=1))
        return nearest


def _columns(resting: tuple[tuple[int, float], ...]) -> list[int]:
    """Return the columns of balls that rest."""
    return [column + k for column, _ in resting for k in (0, 1)]


def sections_of(p: Any, attractor: Attractor, owner: int) -> list[Section]:
    """Return the section of a periodic attractor at the forcing phase of its final state, and that of its mirror image.

    Parameters
    ----------
    p : Params, or the parameters of another system
    attractor : Attractor
        A periodic one.
    owner : int
        Its number.
    """
    at: dict[str, Any] = {name: value for name, value in attractor.final.items() if name not in ("t", "phase")}
    phase, periods = attractor.final["phase"], int(attractor.p or 1)
    mirror, names = p.system.mirror, names_of(p)
    run = simulate(p, **at, phi=phase, periods=periods + mirror.shift)
    times = np.arange(periods) * p.period
    found = []
    for mirrored in (False, True) if p.mirrored and not attractor.symmetric else (False,):
        samples = run.sample(times=np.minimum(times + (mirror.shift * p.period if mirrored else 0.0), run.t_end))
        points = np.stack([samples[name] for name in names], axis=1) * (mirror.sign if mirrored else 1.0)
        points = sort_alike(p, points)
        scale = max(1e-3, float(np.max(np.abs(points[:, 1::2]))))
        resting = _resting(p, points, attractor.measures.max_abs_x1)
        frames = np.stack([_frame(p, point, phase, periods, _columns(resting)) for point in points])
        found.append(Section(owner, mirrored, points, frames, scale, resting))
    return found


def _resting(p: Any, points: Floats, reach: float) -> tuple[tuple[int, float], ...]:
    """Return the balls that rest on an orbit whose largest displacement is `reach`; a tilt leaves none where it is."""
    if not p.mirrored:
        return ()
    names = names_of(p)
    columns = [(names.index(f"x2_{ball}"), beta) for ball, beta in enumerate(getattr(p, "beta", ()), start=1)]
    return tuple((x, beta - reach) for x, beta in columns if np.all(points[:, x + 1] == 0.0))


def _frame(p: Any, point: Floats, phase: float, periods: int, without: list[int]) -> npt.NDArray[np.complex128]:
    at: dict[str, Any] = dict(zip(names_of(p), point.tolist(), strict=True))
    run = simulate(p, **at, phi=phase, periods=periods)
    growth = tangent_map(run)
    if without:
        growth = np.delete(np.delete(growth, without, axis=0), without, axis=1)
    vectors = np.linalg.eig(growth)[1].astype(np.complex128)
    if not np.linalg.cond(vectors) < FLAT:
        return np.eye(len(growth), dtype=np.complex128)
    return np.asarray(np.linalg.inv(vectors), dtype=np.complex128)
