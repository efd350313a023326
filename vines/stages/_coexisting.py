"""The attractors that coexist at a point of a sweep: that of its own start, and those of random starts."""

from __future__ import annotations

from typing import Any

import numpy as np

from vines.attractors import Attractor, settle
from vines.dynamics import no_ball
from vines.model import Word

__all__ = ["attractor_rows", "coexisting"]

SAME = 1e-6
"""Two periodic attractors of one name are one, or mirror images, if their max|x1| and K2/K1 differ by less."""


def coexisting(own: Attractor, *, random: int, seed: int, settle_for: int, record: int) -> list[tuple[Attractor, int]]:
    """Return the attractors at a point, no two alike, and how many of the random starts came to each.

    Parameters
    ----------
    own : Attractor
        That of the point's own start; it comes first.
    random : int
        Number of random starts: the oscillator within twice its amplitude without a ball (at most 3), the ball
        anywhere in the cavity and as fast.
    seed : int
        Seed; the starts of a point follow from it and the parameters alone.
    settle_for, record : int
        Forcing periods, as for the point itself.
    """
    found = [own]
    counts = [0]
    p = own.params
    bits = np.array(list(p.as_dict().values())).view(np.uint32)
    rng = np.random.default_rng([seed, *bits.tolist()])
    size = float(np.clip(2.0 * no_ball(p), 0.1, 3.0))
    for _ in range(random):
        x1, v1, v2 = rng.uniform(-size, size, 3).tolist()
        x2 = x1 - float(rng.uniform(-1.0, 1.0))
        other = settle(p, x1=x1, v1=v1, x2=x2, v2=v2, settle=settle_for, record=record)
        for k, known in enumerate(found):
            if _same(known, other):
                counts[k] += 1
                break
        else:
            found.append(other)
            counts.append(1)
    return list(zip(found, counts, strict=True))


def _same(a: Attractor, b: Attractor) -> bool:
    if (a.regime, a.settled, a.word is None) != (b.regime, b.settled, b.word is None):
        return False
    if a.name is None or b.name is None:
        return True
    # n:m and its mirror image m:n are one attractor.
    if (a.p, sorted((a.n or 0, a.m or 0))) != (b.p, sorted((b.n or 0, b.m or 0))):
        return False
    pairs = ((a.measures.max_abs_x1, b.measures.max_abs_x1), (a.measures.kinetic_ratio, b.measures.kinetic_ratio))
    return all(abs(x - y) <= SAME * (1.0 + abs(x)) for x, y in pairs)


def attractor_rows(point_id: str, found: list[tuple[Attractor, int]], random: int) -> list[dict[str, Any]]:
    """Return rows of the table ``attractors``; shares are null where no start was drawn."""
    rows = []
    for k, (attractor, count) in enumerate(found):
        p, m = attractor.params, attractor.measures
        share = count / random if random else None
        yardstick = no_ball(p)
        rows.append(
            {
                "point_id": point_id,
                **p.as_dict(),
                "attractor": k,
                "fraction": share,
                "fraction_error": (share * (1 - share) / random) ** 0.5 if share is not None else None,
                "regime": attractor.regime,
                "name": attractor.name,
                "alias": Word(attractor.word).alias if attractor.word else None,
                "word": attractor.word,
                "symmetric": attractor.symmetric,
                "kinetic_ratio": m.kinetic_ratio,
                "max_abs_x1": m.max_abs_x1,
                "rms_x1": m.rms_x1,
                "reduction": m.max_abs_x1 / yardstick if yardstick > 0 else None,
                "impacts_per_period": m.impacts_per_period,
                "sticks_per_period": m.sticks_per_period,
                **{f"end_{name}": attractor.final[name] for name in ("x1", "v1", "x2", "v2", "phase")},
            }
        )
    return rows
