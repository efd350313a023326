"""Which start comes to which attractor: a grid of start states over two coordinates, all other ones given."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors._attractor import Attractor
from vines.attractors._carried import carried, names_of, part_alike
from vines.attractors._search import Lifetime, Search
from vines.attractors._settle import APART
from vines.attractors._shares import share_error
from vines.bounds import check_periods, shown
from vines.domains import Named, Number, Numbers, Parameters, Whole, stated
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import LARGEST
from vines.errors import StateError, nearest

__all__ = ["Basins", "basins"]

Floats = npt.NDArray[Any]


@dataclass(frozen=True)
class Basins:
    """The basins of a grid of starts; one entry of the arrays for each cell.

    Attributes
    ----------
    params : Params, or those of another system
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
    lifetimes : list of Lifetime
        For each of them, how long runs stay on it: chaos may be left after a long time.
    """

    params: Any
    axes: tuple[str, str]
    x: Floats
    y: Floats
    level: npt.NDArray[np.int64]
    weight: Floats
    label: npt.NDArray[np.int64]
    mirrored: npt.NDArray[np.bool_]
    periods: Floats
    attractors: list[Attractor] = field(repr=False)
    lifetimes: list[Lifetime] = field(repr=False)

    def fraction(self, k: int) -> tuple[float, float]:
        """Return the share of the starts that come to attractor k (-1: unsettled) and its standard error."""
        share = math.fsum(self.weight[self.label == k].tolist())
        # Weights differ after a refinement: the effective number of independent cells.
        return share, share_error(share, 1.0 / float(np.sum(self.weight**2)))


@stated(
    p=Parameters(),
    others=Named(Number(), optional=True),
    refine=Whole(least=0, most=12),
    settle=Number(least=0),
    patience=Number(least=0),
    watch=Number(least=16),
)
def basins(
    p: Any,
    x: tuple[str, Sequence[float] | Floats],
    y: tuple[str, Sequence[float] | Floats],
    *,
    others: Mapping[str, float] | None = None,
    refine: int = 0,
    settle: float = 256,
    patience: float = 4000,
    watch: float = 128,
) -> Basins:
    """Find to which attractor each start of a grid comes.

    Parameters
    ----------
    p : Params, or the parameters of another system
        Parameters.
    x, y : (name, values)
        Two of x1, v1, x2, v2, phase, or of the coordinates of another system and phase, with evenly spaced values, the
        centres of the cells.
    others : mapping, optional
        The other coordinates, 0 where nothing is said. Starts with a ball outside its cavity, |x1 - x2| > 1, are left
        out; balls that would start alike, and so move as one for ever, start `APART`.
    refine : int
        How often cells whose neighbours belong to another attractor are halved in both directions.
    settle : float
        Forcing periods after which starts that came to no known orbit are classified, as by `classify_many`.
    patience : float
        Forcing periods after which a start that has not settled is called so. Chaos that is left sooner than that is a
        transient, and its starts have not settled.
    watch : float
        Forcing periods, >= 16, after which an exponent is believed.

    Returns
    -------
    Basins

    Raises
    ------
    StateError
        If the coordinates are not two different ones, or no start of the grid is allowed.

    Examples
    --------
    >>> from vines.model import Params
    >>> found = basins(Params(mu=0.01, A=0.023), ("x2", [-0.5, 0.0, 0.5]), ("v2", [0.1, 0.2]))
    >>> [a.name for a in found.attractors], found.fraction(0)[0]
    (['2:1'], 1.0)
    """
    for label_of, axis in (("x", x), ("y", y)):
        if not (isinstance(axis, tuple | list) and len(axis) == 2 and isinstance(axis[0], str)):
            raise StateError(f"{label_of} is {shown(axis)}; give a name with its values, such as ('x2', [0.0, 0.1])")
        Numbers(Number(least=-LARGEST, most=LARGEST), least=1).check(label_of, axis[1], StateError)
    for name, value in (("settle", settle), ("patience", patience), ("watch", watch)):
        check_periods(name, value, p.period)
    names = (x[0], y[0])
    known = [each.name for each in p.system.start]
    for name in (*names, *(others or {})):
        if name not in known:
            raise StateError(f"unknown coordinate {name!r}: {nearest(name, known)}")
    if names[0] == names[1] or set(names) & set(others or {}):
        raise StateError(f"the coordinates {names[0]}, {names[1]} must be two, and not among the others")
    xs, ys = np.asarray(x[1], dtype=np.float64), np.asarray(y[1], dtype=np.float64)
    grid = _Grid(p, names, dict(others or {}))
    search = Search(p, grid.phase, settle, patience, watch)
    gx, gy = (values.ravel() for values in np.meshgrid(xs, ys, indexing="xy"))
    inside = grid.allowed(gx, gy)
    if not inside.any():
        raise StateError("no start of the grid has every ball in its cavity, |x1 - x2| <= 1; give other coordinates")
    label = np.full(len(gx), -2)
    mirrored = np.zeros(len(gx), dtype=bool)
    periods = np.zeros(len(gx))
    label[inside], mirrored[inside], periods[inside] = search.run(grid.states(gx[inside], gy[inside]))
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
        allowed = grid.allowed(fx, fy)
        found = np.full(len(fx), -2)
        image = np.zeros(len(fx), dtype=bool)
        wait = np.zeros(len(fx))
        if allowed.any():
            found[allowed], image[allowed], wait[allowed] = search.run(grid.states(fx[allowed], fy[allowed]))
        quarters = np.where(allowed, np.tile(weight, 4) / 4, 0.0)
        cells.append((fx, fy, np.full(len(fx), k + 1), quarters, found, image, wait))
        # Cut again where the four quarters of a cell, or they and the cell, are not all alike.
        four = (2 * found + image).reshape(4, -1)
        edge = np.tile((four != before).any(axis=0), 4) & allowed
    columns: list[Any] = [np.concatenate(parts) for parts in zip(*cells, strict=True)]
    keep = columns[3] > 0
    gx, gy, level, weight, label, mirrored, periods = (column[keep] for column in columns)
    weight = weight / weight.sum()
    found = search.attractors, search.lifetimes()
    return Basins(p, names, gx, gy, level, weight, label, mirrored, periods, *found)


def _edges(label: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Return where a cell has a neighbour of another attractor, corners included."""
    wide = np.pad(label, 1, mode="edge")
    ny, nx = label.shape
    return np.any(
        [wide[1 + i : 1 + i + ny, 1 + j : 1 + j + nx] != label for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0
    )


class _Grid:
    """The starts: two coordinates from the grid, the others given, all brought to one phase of the forcing."""

    def __init__(self, p: Any, names: tuple[str, str], others: dict[str, float]) -> None:
        self.p, self.names, self.others = p, names, others
        self.phase = others.get("phase", 0.0) % (2.0 * math.pi)

    def starts(self, x: Floats, y: Floats) -> dict[str, Floats]:
        """Return all coordinates of the starts."""
        full = {each.name: np.full(len(x), self.others.get(each.name, 0.0)) for each in self.p.system.start}
        full[self.names[0]], full[self.names[1]] = np.array(x), np.array(y)
        return full

    def allowed(self, x: Floats, y: Floats) -> npt.NDArray[np.bool_]:
        """Return which starts have every ball in its cavity."""
        return np.all(np.abs(room_of(self.p).gaps(self.p, self.starts(x, y))) <= 1.0, axis=-1)

    def states(self, x: Floats, y: Floats) -> Floats:
        """Return the states of the starts, or of what they have become when the forcing is at the common phase."""
        full = self.starts(x, y)
        states = np.stack([full[name] for name in names_of(self.p)], axis=1)
        part_alike(self.p, states, APART)
        if "phase" in self.names:
            lag = (self.phase - full["phase"]) % (2.0 * math.pi) / (2.0 * math.pi)
            for share in np.unique(lag[lag > 0]).tolist():
                some = lag == share
                states[some], _ = carried(self.p, states[some], full["phase"][some], share)
        return states
