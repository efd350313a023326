"""What many runs of a system beside the VI-NES settle to: each as by `settle_from`, on all cores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._attractor import Attractor
from vines.attractors._classified import Classified
from vines.attractors._naming import attractor_from
from vines.attractors._patience import Patience
from vines.attractors._settle import Settled, parted, settled
from vines.dynamics.kernels import room_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.dynamics.runs import each_thread, impacts_of, measures_from, measures_of, start_of, threads_allowed
from vines.errors import ParameterError, StateError
from vines.model import Parameters

__all__ = ["FamilyClassified", "classify_family"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class FamilyClassified(Classified):
    """What many runs of another system settled to; see `Classified`. `parameters` and `starts` are as it declares them.

    Attributes
    ----------
    params : tuple of Parameters
        Those of each run, as one object with names.
    """

    params: tuple[Any, ...] = field(default=(), repr=False)

    def attractor(self, k: int) -> Attractor:
        """Return run k as `settle` would."""
        p = self.params[k]
        hits = impacts_of(np.empty((0, room_of(p).layout(p).width)), p)
        kept = hits if self.hits is None else self.hits[k]
        return attractor_from(p, self.verdicts[k], self.totals[k], self.words[k], kept, 0.0, True)

    @property
    def measures(self) -> npt.NDArray[np.void]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Energy measures as of `Classified`, of all balls together; those of each are in ``attractor(k).measures``."""
        out = measures_of(np.ones(len(self)), self.totals[:, : entry.TOTALS])
        # Which masses the totals have in them already is for each system to say.
        each = [measures_from(p, totals) for p, totals in zip(self.params, self.totals, strict=True)]
        out["kinetic_2"] = [one.kinetic_2 for one in each]
        out["kinetic_ratio"] = [one.kinetic_ratio for one in each]
        return out

    @property
    def sticks(self) -> Floats:
        """Spells of sticking per forcing period."""
        count = self.totals[:, entry.STICKS_LEFT] + self.totals[:, entry.STICKS_RIGHT]
        periods = np.array([p.period for p in self.params])
        with np.errstate(invalid="ignore", divide="ignore"):
            return count * periods / self.totals[:, entry.DURATION]

    @property
    def final(self) -> Floats:
        """State at the end by the names of the system, shape (n, k): its coordinates, and the phase [rad]."""
        return np.array([list(self._end(k).values()) for k in range(len(self))])

    def _end(self, k: int) -> dict[str, float]:
        p, verdict = self.params[k], self.verdicts[k]
        room = room_of(p)
        *at, phase = verdict[v.FINAL : v.FINAL + 5].tolist()
        more = room.layout(p).width - col.ROW
        return room.leave(p, at, phase, verdict[len(verdict) - more :].tolist()) | {"phase": phase}


def classify_family(
    params: Parameters | Sequence[Parameters],
    starts: Mapping[str, npt.ArrayLike] | None,
    how: Patience,
    *,
    apart: float,
    impacts: bool,
    errors: bool,
    threads: int | None,
) -> FamilyClassified:
    """Settle many points or starts of one system.

    Parameters
    ----------
    params : Parameters, or sequence of them
        One point for all runs, or one a run.
    starts : mapping, optional
        Coordinates by the names of the system and `phase`: one value for all runs or one a run; what every ball has may
        be given by its name without a number, in rows of one value a ball.
    how : Patience
    apart : float
        As for `settle`.
    impacts : bool
        Whether to keep the recorded impacts.
    errors : bool
        As for `settle`.
    threads : int or None

    Raises
    ------
    ParameterError, StateError
        If the points are not of one system, lengths do not fit together, or a start is not a state of the system.
    """
    given = {name: np.asarray(values, dtype=np.float64) for name, values in (starts or {}).items()}
    points = (params,) if isinstance(params, Parameters) else tuple(params)
    if not points:
        raise ParameterError("params is empty; give at least one point")
    kinds = {(p.system.name, p.system.balls, p.system.modes) for p in points}
    if len(kinds) > 1:
        raise ParameterError(
            f"points of {len(kinds)} systems or numbers of balls or modes; classify those of each alone"
        )
    n = _count(len(points), given)
    points = points * n if len(points) == 1 else points
    begins = []
    for k, p in enumerate(points):
        own = {name: values if values.ndim == 0 else values[k] for name, values in given.items()}
        phase = float(own.pop("phase", 0.0))
        named = {name: float(each) if each.ndim == 0 else each.tolist() for name, each in own.items()}
        begins.append(parted(p, start_of(p, named, 0.0, phase), apart))
    found: list[Settled | None] = [None] * n

    def work(block: slice) -> None:
        for k in range(block.start, block.stop):
            found[k] = settled(points[k], begins[k], how, errors)

    each_thread(work, [slice(k, k + 1) for k in range(n)], threads_allowed() if threads is None else max(1, threads))
    done = [each for each in found if each is not None]
    words = np.empty(n, dtype=object)
    words[:] = [each.word for each in done]
    return FamilyClassified(
        np.array([list(p.as_dict().values()) for p in points]),
        np.array([_named(p, begin) for p, begin in zip(points, begins, strict=True)]),
        words,
        np.array([each.verdict for each in done]),
        np.array([each.totals for each in done]),
        [each.hits for each in done] if impacts else None,
        points,
    )


def _count(points: int, given: Mapping[str, Floats]) -> int:
    """Return the number of runs."""
    lengths = {"params": points} | {name: len(values) for name, values in given.items() if values.ndim}
    n = max(lengths.values())
    for name, length in lengths.items():
        if length not in ({n} if name != "params" else {1, n}):
            raise StateError(f"{name} has {length} values, others have {n}; give one for all runs or one a run")
    return n


def _named(p: Any, begin: tuple[Any, ...]) -> list[float]:
    """Return a start by the names of the system, and its phase."""
    x1, v1, x2, v2, phase = begin
    balls = np.column_stack([np.atleast_1d(x2), np.atleast_1d(v2)]).ravel().tolist()
    at = (x1, v1, balls[0], balls[1])
    return [*room_of(p).leave(p, at, phase, [1.0, 0.0, 0.0, *balls]).values(), float(phase)]
