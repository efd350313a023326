"""Which start comes to which attractor: a grid of start states over two coordinates, all other ones given."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._settle import settle_from
from vines.dynamics import ensemble, simulate
from vines.errors import StateError, nearest
from vines.model import Params

__all__ = ["COORDINATES", "Basins", "basins"]

Floats = npt.NDArray[Any]

COORDINATES = ("x1", "v1", "x2", "v2", "phase")
ROUND = 32
"""Forcing periods between two looks at the states."""

NEAR = 0.02
"""A state counts as captured if it is this near to an orbit, in units of the largest speed, and comes nearer twice."""

EXPLORE = 12
"""Starts that are settled one by one, where nothing known is near, before the rest is called unsettled."""


@dataclass(frozen=True)
class Basins:
    """The basins of a grid of starts; one entry of the arrays for each cell.

    Attributes
    ----------
    params : Params
        Parameters.
    axes : tuple of str
        The two coordinates.
    x, y : ndarray, shape (n,)
        Centres of the cells.
    level : ndarray of int
        How often the cell was halved in both directions.
    weight : ndarray
        Share of the cell in the area of the allowed starts; they sum to 1.
    label : ndarray of int
        Index into `attractors`, -1 where the start had not settled.
    mirrored : ndarray of bool
        Whether it came to the mirror image (x, t) -> (-x, t + T/2) of that attractor.
    periods : ndarray
        Forcing periods after which that was clear.
    attractors : list of Attractor
        What was found, no two of them mirror images of each other.
    """

    params: Params
    axes: tuple[str, str]
    x: Floats
    y: Floats
    level: npt.NDArray[np.int64]
    weight: Floats
    label: npt.NDArray[np.int64]
    mirrored: npt.NDArray[np.bool_]
    periods: Floats
    attractors: list[Attractor] = field(repr=False)

    def fraction(self, k: int) -> tuple[float, float]:
        """Return the share of the starts that come to attractor k (-1: unsettled) and its standard error."""
        share = float(np.sum(self.weight[self.label == k]))
        # Weights differ after a refinement: the effective number of independent cells.
        number = 1.0 / float(np.sum(self.weight**2))
        return share, math.sqrt(max(share * (1.0 - share), 0.0) / number)


def basins(
    p: Params,
    x: tuple[str, Sequence[float] | Floats],
    y: tuple[str, Sequence[float] | Floats],
    *,
    others: Mapping[str, float] | None = None,
    refine: int = 0,
    patience: float = 4000,
) -> Basins:
    """Find to which attractor each start of a grid comes.

    Parameters
    ----------
    p : Params
        Parameters.
    x, y : (name, values)
        Two of x1, v1, x2, v2, phase with evenly spaced values, the centres of the cells.
    others : mapping, optional
        The other coordinates, 0 where nothing is said. Starts with a gap |x1 - x2| > 1 are left out.
    refine : int
        How often cells whose neighbours belong to another attractor are halved in both directions.
    patience : float
        Forcing periods after which a start that comes to nothing known is called unsettled.

    Returns
    -------
    Basins

    Raises
    ------
    StateError
        If the coordinates are not two different ones, or no start of the grid is allowed.

    Examples
    --------
    >>> found = basins(Params(mu=0.01, A=0.023), ("x2", [-0.5, 0.0, 0.5]), ("v2", [0.1, 0.2]))
    >>> [a.name for a in found.attractors], found.fraction(0)[0]
    (['2:1'], 1.0)
    """
    names = (x[0], y[0])
    for name in (*names, *(others or {})):
        if name not in COORDINATES:
            raise StateError(f"unknown coordinate {name!r}: {nearest(name, COORDINATES)}")
    if names[0] == names[1] or set(names) & set(others or {}):
        raise StateError(f"the coordinates {names[0]}, {names[1]} must be two, and not among the others")
    xs, ys = np.asarray(x[1], dtype=np.float64), np.asarray(y[1], dtype=np.float64)
    search = _Search(p, names, dict(others or {}), patience)
    gx, gy = (grid.ravel() for grid in np.meshgrid(xs, ys, indexing="xy"))
    inside = search.allowed(gx, gy)
    if not inside.any():
        raise StateError("no start of the grid has |x1 - x2| <= 1: the ball would be outside the cavity")
    label = np.full(len(gx), -2)
    mirrored = np.zeros(len(gx), dtype=bool)
    periods = np.zeros(len(gx))
    label[inside], mirrored[inside], periods[inside] = search.run(gx[inside], gy[inside])
    cells: list[Any] = [
        (gx, gy, np.zeros(len(gx), dtype=np.int64), np.where(inside, 1.0, 0.0), label, mirrored, periods)
    ]
    step = [float(v[1] - v[0]) if len(v) > 1 else 0.0 for v in (xs, ys)]
    edge = _edges((2 * label + mirrored).reshape(len(ys), len(xs))).ravel() & inside
    for k in range(refine):
        step = [0.5 * h for h in step]
        whole = cells[-1]
        # The halved cells take the place of those that they were cut from.
        cells[-1] = tuple(column[~edge] for column in whole)
        px, py, weight, before = whole[0][edge], whole[1][edge], whole[3][edge], 2 * whole[4][edge] + whole[5][edge]
        fx = np.concatenate([px + a * step[0] / 2 for a in (-1, 1) for _ in (0, 1)])
        fy = np.concatenate([py + b * step[1] / 2 for _ in (0, 1) for b in (-1, 1)])
        allowed = search.allowed(fx, fy)
        found = np.full(len(fx), -2)
        image = np.zeros(len(fx), dtype=bool)
        wait = np.zeros(len(fx))
        if allowed.any():
            found[allowed], image[allowed], wait[allowed] = search.run(fx[allowed], fy[allowed])
        quarters = np.where(allowed, np.tile(weight, 4) / 4, 0.0)
        cells.append((fx, fy, np.full(len(fx), k + 1), quarters, found, image, wait))
        # Cut again where the four quarters of a cell, or they and the cell, are not all alike.
        four = (2 * found + image).reshape(4, -1)
        edge = np.tile((four != before).any(axis=0), 4) & allowed
    columns: list[Any] = [np.concatenate(parts) for parts in zip(*cells, strict=True)]
    keep = columns[3] > 0
    gx, gy, level, weight, label, mirrored, periods = (column[keep] for column in columns)
    return Basins(p, names, gx, gy, level, weight / weight.sum(), label, mirrored, periods, search.attractors)


def _edges(label: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Return where a cell has a neighbour of another attractor, corners included."""
    wide = np.pad(label, 1, mode="edge")
    ny, nx = label.shape
    return np.any(
        [wide[1 + i : 1 + i + ny, 1 + j : 1 + j + nx] != label for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0
    )


class _Search:
    """The attractors found so far, and how starts are brought to them."""

    def __init__(self, p: Params, names: tuple[str, str], others: dict[str, float], patience: float) -> None:
        self.p, self.names, self.others, self.patience = p, names, others, patience
        self.attractors: list[Attractor] = []
        self.points: list[Floats] = []
        """States of each attractor once a period in the phase of the starts, and those of its mirror image."""
        self.whose: list[tuple[int, bool]] = []

    def starts(self, x: Floats, y: Floats) -> dict[str, Floats]:
        """Return all coordinates of the starts."""
        full = {name: np.full(len(x), self.others.get(name, 0.0)) for name in COORDINATES}
        full[self.names[0]], full[self.names[1]] = x, y
        return full

    def allowed(self, x: Floats, y: Floats) -> npt.NDArray[np.bool_]:
        """Return which starts have the ball in the cavity."""
        full = self.starts(x, y)
        return np.abs(full["x1"] - full["x2"]) <= 1.0

    def run(self, x: Floats, y: Floats) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_], Floats]:
        """Return attractor, whether mirrored, and periods needed for each start."""
        state = self.starts(x, y)
        n = len(x)
        label, mirrored, periods = np.full(n, -1), np.zeros(n, dtype=bool), np.zeros(n)
        # Distances to each set of points one and two rounds ago.
        past = [np.full((n, len(self.whose)), np.inf) for _ in range(2)]
        open_ones = np.arange(n)
        elapsed, explored = 0.0, 0
        change = np.full(n, np.inf)
        while len(open_ones) and elapsed < self.patience:
            part = {name: values[open_ones] for name, values in state.items()}
            done = ensemble(self.p, part, periods=ROUND).final
            change[open_ones] = np.max([np.abs(done[name] - part[name]) for name in ("x1", "v1", "v2")], axis=0)
            # After a whole number of periods the phase is that of the start.
            for name in COORDINATES[:4]:
                state[name][open_ones] = done[name]
            elapsed += ROUND
            periods[open_ones] = elapsed
            away = self._distances(done)
            one, two = (before[open_ones] for before in past)
            known = np.full((len(open_ones), len(self.whose)), np.inf)
            known[:, : one.shape[1]] = one
            older = np.full_like(known, np.inf)
            older[:, : two.shape[1]] = two
            captured = (away < NEAR) & (((away <= known) & (known <= older)) | (away < 1e-8))
            captured &= np.isfinite(older) | (away < 1e-8)
            if captured.shape[1]:
                best = np.argmin(np.where(captured, away, np.inf), axis=1)
                hit = captured[np.arange(len(open_ones)), best]
                whose = np.array(self.whose, dtype=np.int64).reshape(-1, 2)
                label[open_ones[hit]] = whose[best[hit], 0]
                mirrored[open_ones[hit]] = whose[best[hit], 1].astype(bool)
            else:
                hit = np.zeros(len(open_ones), dtype=bool)
            past = [np.full((n, len(self.whose)), np.inf) for _ in range(2)]
            past[0][open_ones], past[1][open_ones] = away, known
            open_ones = open_ones[~hit]
            # Where nothing known is near, the start that repeats best is settled by itself.
            if explored < EXPLORE and len(open_ones) and elapsed >= 4 * ROUND:
                lost = open_ones[np.min(past[0][open_ones], axis=1, initial=np.inf) > NEAR]
                if len(lost):
                    k = int(lost[np.argmin(change[lost])])
                    if change[k] < NEAR or (explored == 0 and elapsed >= 8 * ROUND):
                        explored += 1
                        self._learn({name: float(state[name][k]) for name in COORDINATES})
        # What never came near a periodic orbit is on the one other attractor, if there is one.
        wild = [k for k, a in enumerate(self.attractors) if a.p is None]
        if len(wild) == 1:
            label[open_ones] = wild[0]
        return label, mirrored, periods

    def _distances(self, state: npt.NDArray[np.void]) -> Floats:
        out = np.full((len(state), len(self.whose)), np.inf)
        columns = np.stack([state[name] for name in COORDINATES[:4]], axis=1)
        for k, points in enumerate(self.points):
            for point in points:
                scale = max(1e-3, float(np.max(np.abs(points[:, [1, 3]]))))
                out[:, k] = np.minimum(out[:, k], np.max(np.abs(columns - point), axis=1) / scale)
        return out

    def _learn(self, start: dict[str, float]) -> None:
        """Settle a start; keep its attractor if it is periodic, or without impact, and not known yet."""
        found = settle_from(self.p, start, settle=400, patience=20_000, lyapunov=False)
        if not found.settled:
            return
        if found.p is None:
            same = [k for k, a in enumerate(self.attractors) if a.regime == found.regime]
            if not same:
                self.attractors.append(found)
            return
        period = self.p.period
        at = found.final
        # Back to the phase of the starts: less than one period on.
        lag = ((start["phase"] - at["phase"]) % (2 * math.pi)) / (2 * math.pi)
        run = simulate(
            self.p, x1=at["x1"], v1=at["v1"], x2=at["x2"], v2=at["v2"], phi=at["phase"], periods=lag + found.p + 0.5
        )
        times = (lag + np.arange(found.p)) * period
        sets = []
        for shift, sign in ((0.0, 1.0), (0.5 * period, -1.0)):
            s = run.sample(times=np.minimum(times + shift, run.t_end))
            sets.append(sign * np.stack([s[name] for name in COORDINATES[:4]], axis=1))
        for points in self.points:
            if len(points) == len(sets[0]) and np.min(np.max(np.abs(points - sets[0][0]), axis=1)) < 1e-5:
                return
        k = len(self.attractors)
        self.attractors.append(found)
        self.points.append(sets[0])
        self.whose.append((k, False))
        if not found.symmetric:
            self.points.append(sets[1])
            self.whose.append((k, True))
