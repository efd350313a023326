"""The true pattern of a synthetic run, from its true impacts: how many on each end in each forcing period."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["true_pattern"]

_LONGEST = 8
_HOLDS = 0.95


def true_pattern(
    t: npt.NDArray[np.float64], side: npt.NDArray[np.float64], f: float, duration: float
) -> dict[str, Any]:
    """Return the pattern n:m/pT of a run and the part of its periods in which it holds.

    Parameters
    ----------
    t, side : ndarray, shape (n,)
        Times of the impacts [s] and +1 (left) or -1.
    f, duration : float
        Forcing frequency [Hz] and length of the run [s].

    Returns
    -------
    dict
        ``name`` (``"mixed"`` where none holds in 95 % of the periods, ``"none"`` without impacts), ``p``, ``fraction``
        and ``counts``, the share of single periods with each n:m.

    Examples
    --------
    >>> t = np.arange(1, 200) / 20.0
    >>> true_pattern(t, np.where(np.arange(199) % 2, 1.0, -1.0), 10.0, 10.0)["name"]
    '1:1'
    """
    if not len(t):
        return {"name": "none", "p": 1, "fraction": 1.0, "counts": {"0:0": 1.0}}
    phase = np.sort((t * f) % 1.0)
    gaps = np.diff(np.append(phase, phase[0] + 1.0))
    cut = (phase[int(gaps.argmax())] + 0.5 * gaps.max()) % 1.0
    period = np.floor(t * f - cut).astype(int)
    first, last = 0, int(np.floor(duration * f - cut)) - 1
    inside = (period >= first) & (period <= last)
    count = last - first + 1
    left = np.bincount(period[inside & (side > 0)] - first, minlength=count)
    right = np.bincount(period[inside & (side < 0)] - first, minlength=count)
    single = Counter(zip(left.tolist(), right.tolist(), strict=True))
    counts = {f"{n}:{m}": k / count for (n, m), k in single.most_common()}
    best = (0.0, 1, "mixed")
    for p in range(1, _LONGEST + 1):
        if count < 2 * p:
            break
        words = [tuple(zip(left[k : k + p], right[k : k + p], strict=True)) for k in range(count - p + 1)]
        word, _ = Counter(words).most_common(1)[0]
        turned = {word[k:] + word[:k] for k in range(p)}
        fraction = sum(each in turned for each in words) / len(words)
        if fraction >= _HOLDS:
            n, m = int(sum(a for a, _ in word)), int(sum(b for _, b in word))
            name = f"{n}:{m}" if p == 1 else f"{n}:{m}/{p}T"
            return {"name": name, "p": p, "fraction": fraction, "counts": counts}
        best = max(best, (fraction, p, "mixed"))
    return {"name": "mixed", "p": best[1], "fraction": best[0], "counts": counts}
