"""The attractors that coexist at some points: those of their own starts, and those of random starts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vines.attractors._alike import SAME, Motion, apart
from vines.attractors._attractor import Attractor
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.dynamics.kernels import room_of
from vines.model import PARAMETER_NAMES, Params, Word

__all__ = ["coexisting", "random_starts"]


def coexisting(
    own: Sequence[Attractor],
    *,
    random: int,
    seed: int,
    settle: float,
    record: float,
    watch: float,
    largest_p: int | None = None,
    impacts: bool = False,
) -> list[list[tuple[Attractor, int]]]:
    """Return for each point its attractors, no two alike, and how many of the random starts came to each.

    Parameters
    ----------
    own : sequence of Attractor
        Those of the points' own starts; each comes first in its list.
    random : int
        Number of random starts at each point: the oscillator within twice its amplitude without a ball (at most 3), the
        ball anywhere in the cavity and as fast; of another system as its room says.
    seed : int
        Seed; the starts of a point follow from it and the parameters alone.
    settle, record, watch : float
        Forcing periods, as for the points themselves.
    largest_p : int, optional
        As for these.
    impacts : bool
        Whether the attractors of random starts keep their impacts.
    """
    found = [[(attractor, 0)] for attractor in own]
    if not random:
        return found
    starts = np.concatenate([random_starts(attractor.params, random, seed) for attractor in own])
    options: dict[str, Any] = {"settle": settle, "record": record, "watch": watch, "largest_p": largest_p}
    many = _classified([attractor.params for attractor in own], random, starts, options | {"impacts": impacts})
    ratio, size = many.measures["kinetic_ratio"].tolist(), many.measures["max_abs_x1"].tolist()
    regimes, settled = many.regime.tolist(), many.settled.tolist()
    for point, listed in enumerate(found):
        for k in range(point * random, (point + 1) * random):
            word: Word | None = many.words[k]
            counts = (word.n, word.m, word.p) if word else (None, None, None)
            _count(listed, Motion(regimes[k], *counts, ratio[k], size[k]), settled[k], many, k)
    return found


def _count(listed: list[tuple[Attractor, int]], motion: Motion, settled: bool, many: Classified, k: int) -> None:
    """Count run k with the attractor that it came to, or list it as a new one."""
    for at, (known, count) in enumerate(listed):
        if known.settled == settled and apart(Motion.of(known), motion) <= SAME:
            listed[at] = (known, count + 1)
            return
    listed.append((many.attractor(k), 1))


def _classified(points: Sequence[Any], each: int, starts: np.ndarray, options: dict[str, Any]) -> Classified:
    """Return what so many starts at each of the points settle to."""
    named = dict(zip((each.name for each in points[0].system.state), starts.T, strict=True))
    if not isinstance(points[0], Params):
        # No two of them start alike, so that balls need not be told apart.
        return classify_many([p for p in points for _ in range(each)], named, **options, apart=0.0)
    columns = np.array([[getattr(p, name) for name in PARAMETER_NAMES] for p in points])
    return classify_many(dict(zip(PARAMETER_NAMES, np.repeat(columns, each, axis=0).T, strict=True)), named, **options)


def random_starts(p: Any, random: int, seed: int) -> np.ndarray:
    """Return random starts at phase 0, shape (random, d): the coordinates of the system."""
    bits = np.array(list(p.as_dict().values())).view(np.uint32)
    rng = np.random.default_rng([seed, *bits.tolist()])
    room = room_of(p)
    drawn = [room.draw(p, rng) for _ in range(random)]
    return np.array([[start[each.name] for each in p.system.state] for start in drawn])
