"""Periodic attractors as points of a section at one forcing phase, and which states come to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.dynamics import simulate, tangent_map
from vines.model import STATE_NAMES, V1, V2, VI_NES, Params

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
    points : ndarray, shape (p, 4)
        x1, v1, x2, v2.
    frames : ndarray of complex, shape (p, 4, 4)
        Maps the difference to a point, over `scale`, to its parts along the eigenvectors of the period map: what is
        near the orbit comes nearer in these coordinates at every return, however it turns.
    scale : float
        Largest speed among the points.
    """

    owner: int
    mirrored: bool
    points: Floats
    frames: npt.NDArray[np.complex128]
    scale: float

    def distance(self, states: Floats) -> Floats:
        """Return how far states, shape (n, 4), are from the nearest of the points, inf where that is not near."""
        nearest = np.full(len(states), np.inf)
        for point, frame in zip(self.points, self.frames, strict=True):
            away = (states - point) / self.scale
            # Eigenvectors have length 1: a difference is at most the sum of its four parts.
            close = np.flatnonzero(np.max(np.abs(away), axis=1) < 4.0 * NEAR)
            nearest[close] = np.minimum(nearest[close], np.max(np.abs(away[close] @ frame.T), axis=1))
        return nearest


def sections_of(p: Params, attractor: Attractor, owner: int) -> list[Section]:
    """Return the section of a periodic attractor at the forcing phase of its final state, and that of its mirror image.

    Parameters
    ----------
    p : Params
    attractor : Attractor
        A periodic one.
    owner : int
        Its number.
    """
    at = attractor.final
    periods = int(attractor.p or 1)
    run = simulate(
        p, x1=at["x1"], v1=at["v1"], x2=at["x2"], v2=at["v2"], phi=at["phase"], periods=periods + VI_NES.mirror.shift
    )
    times = np.arange(periods) * p.period
    found = []
    for mirrored in (False, True) if not attractor.symmetric else (False,):
        samples = run.sample(times=np.minimum(times + (VI_NES.mirror.shift * p.period if mirrored else 0.0), run.t_end))
        points = np.stack([samples[name] for name in STATE_NAMES], axis=1) * (VI_NES.mirror.sign if mirrored else 1.0)
        scale = max(1e-3, float(np.max(np.abs(points[:, [V1, V2]]))))
        frames = np.stack([_frame(p, point, at["phase"], periods) for point in points])
        found.append(Section(owner, mirrored, points, frames, scale))
    return found


def _frame(p: Params, point: Floats, phase: float, periods: int) -> npt.NDArray[np.complex128]:
    x1, v1, x2, v2 = point.tolist()
    run = simulate(p, x1=x1, v1=v1, x2=x2, v2=v2, phi=phase, periods=periods)
    vectors = np.linalg.eig(tangent_map(run))[1].astype(np.complex128)
    if not np.linalg.cond(vectors) < FLAT:
        return np.eye(4, dtype=np.complex128)
    return np.asarray(np.linalg.inv(vectors), dtype=np.complex128)
