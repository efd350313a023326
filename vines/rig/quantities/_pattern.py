"""Pattern n:m/pT of a train of impacts, with the fraction of periods that show it."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.model import VI_NES

__all__ = ["HOLDS", "Pattern", "Periods", "cut_into_periods", "find_pattern"]

Floats = npt.NDArray[np.float64]

HOLDS = 0.95
"""Least fraction of periods that must match for a pattern to hold."""

_LONGEST = 6
_TWO_SIDED = 0.85


@dataclass(frozen=True, slots=True, eq=False)
class Periods:
    """Impacts sorted into forcing periods.

    Attributes
    ----------
    cut : float
        Phase of the forcing at which a period begins [rad]: the middle of the widest gap between impacts.
    number : ndarray of int, shape (K,)
        Period of each impact.
    words : list of str
        Sides in each complete period, such as ``"LR"``.
    first : int
        Number of the first complete period.
    """

    cut: float
    number: npt.NDArray[np.int64]
    words: list[str]
    first: int

    @property
    def counts(self) -> list[tuple[int, int]]:
        """Impacts on the left and on the right in each complete period."""
        of = {word: (word.count("L"), word.count("R")) for word in set(self.words)}
        return [of[word] for word in self.words]


@dataclass(frozen=True, slots=True)
class Pattern:
    """What the impacts repeat.

    Attributes
    ----------
    name : str
        ``n:m`` or ``n:m/pT``; ``mixed`` if none holds in 95 % of the periods, ``none`` without impacts.
    n, m, p : int
        Impacts on the left and on the right in p periods; of the most frequent pattern if mixed.
    word : tuple of str
        Sides in each of the p periods.
    fraction : float
        Fraction of periods that match.
    fractions : mapping of str to float
        Fractions of periods with each n:m, the frequent ones first.
    """

    name: str
    n: int
    m: int
    p: int
    word: tuple[str, ...]
    fraction: float
    fractions: dict[str, float]

    @property
    def holds(self) -> bool:
        """Whether a pattern holds."""
        return self.name not in ("mixed", "none")


def cut_into_periods(unwrapped: Floats, side: Floats, span: tuple[float, float], cut: float | None = None) -> Periods:
    """Sort impacts into forcing periods that begin where impacts are rarest.

    Parameters
    ----------
    unwrapped : ndarray, shape (K,)
        Omega t + phi of each impact, in their order, not reduced mod 2 pi [rad].
    side : ndarray, shape (K,)
        +1 L, -1 R.
    span : tuple of float
        Phase at the start and the end of the record [rad]; only periods inside it count.
    cut : float, optional
        Where to cut; the widest gap if left out.
    """
    if cut is None:
        cut = _widest_gap(unwrapped)
    number = np.floor((unwrapped - cut) / (2 * np.pi)).astype(np.int64)
    first, last = int(np.ceil((span[0] - cut) / (2 * np.pi))), int(np.floor((span[1] - cut) / (2 * np.pi)))
    begin = np.searchsorted(number, np.arange(first, max(last, first) + 1)).tolist()
    letters = "".join(np.where(side > 0, *VI_NES.letters([1.0, -1.0])))
    words = [letters[low:high] for low, high in itertools.pairwise(begin)]
    return Periods(cut, number, words, first)


def find_pattern(periods: Periods, unwrapped: Floats | None = None) -> Pattern:
    """Return the pattern with the smallest p that holds in at least 95 % of the periods, else ``mixed``.

    Parameters
    ----------
    periods : Periods
    unwrapped : ndarray, shape (K,), optional
        Phases, to tell 2:2/2T from 1:1: the counts of both are alike, their impact times alternate.

    Examples
    --------
    >>> train = np.cumsum(np.full(40, np.pi))
    >>> sides = np.tile([1.0, -1.0], 20)
    >>> find_pattern(cut_into_periods(train, sides, (0.0, 40 * np.pi))).name
    '1:1'
    """
    words = periods.words
    counts = periods.counts
    if not sum(map(len, words)):
        return Pattern("none", 0, 0, 1, ("",), 1.0, {"0:0": 1.0})
    fractions = {f"{n}:{m}": k / len(counts) for (n, m), k in Counter(counts).most_common()}
    best: tuple[float, int, list[tuple[int, int]]] | None = None
    for p in range(1, _LONGEST + 1):
        if len(counts) < 4 * p:
            break
        most = [Counter(counts[k::p]).most_common(1)[0] for k in range(p)]
        usual, fraction = [each for each, _ in most], sum(n for _, n in most) / len(counts)
        if fraction >= HOLDS:
            best = (fraction, p, usual)
            break
        if best is None or fraction > best[0] + 0.1:
            best = (fraction, p, usual)
    if best is None:
        best = (max(fractions.values()), 1, [Counter(counts).most_common(1)[0][0]])
    fraction, p, usual = best
    if fraction >= HOLDS and unwrapped is not None and alternates(periods, unwrapped, usual, p):
        p, usual = 2 * p, usual * 2
    n, m = sum(c[0] for c in usual), sum(c[1] for c in usual)
    word = tuple(
        Counter(w for w, c in zip(words[k::p], counts[k::p], strict=True) if c == usual[k]).most_common(1)[0][0]
        for k in range(p)
    )
    name = (f"{n}:{m}" if p == 1 else f"{n}:{m}/{p}T") if fraction >= HOLDS else "mixed"
    return Pattern(name, n, m, p, word, fraction, fractions)


def alternates(periods: Periods, unwrapped: Floats, usual: list[tuple[int, int]], p: int) -> bool:
    """Say whether impact times alternate from one repetition to the next, as after a period doubling.

    The alternating part (-1)^j (phase_j - mean) of a doubled orbit stays on one side of zero (its mean modulus squared
    is its mean square), that of noise near a doubling is normal about zero (2/pi of it), whatever its correlation.
    """
    first, counts = periods.first, periods.counts
    complete = [j for j in range(0, len(counts) - p + 1, p) if counts[j : j + p] == usual]
    impacts = sum(a + b for a, b in usual)
    if len(complete) < 16 or not impacts:
        return False
    begin = np.searchsorted(periods.number, np.array(complete) + first)
    phase = unwrapped[begin[:, None] + np.arange(impacts)] - periods.cut
    phase = phase - 2 * np.pi * np.array(complete)[:, None] - 2 * np.pi * first
    sign = np.where((np.array(complete) // p) % 2 == 0, 1.0, -1.0)
    # Slow wander is no alternation: take half the difference from the neighbours' mean.
    wave = sign[1:-1, None] * (0.5 * phase[1:-1] - 0.25 * (phase[:-2] + phase[2:]))
    adjacent = (np.diff(complete)[1:] == p) & (np.diff(complete)[:-1] == p)
    wave = wave[adjacent]
    if len(wave) < 16:
        return False
    leading = np.linalg.svd(wave, full_matrices=False)[2][0] if impacts > 1 else np.ones(1)
    along = wave @ leading
    return bool(np.mean(np.abs(along)) ** 2 > _TWO_SIDED * np.mean(along**2) and abs(np.mean(np.sign(along))) > 0.9)


def _widest_gap(unwrapped: Floats) -> float:
    """Return the phase [rad] in the middle of the widest interval that holds at most 2 % of the impacts."""
    if not len(unwrapped):
        return 0.0
    phase = np.sort(np.mod(unwrapped, 2 * np.pi))
    allowed = int(0.02 * len(phase))
    around = np.concatenate([phase, phase + 2 * np.pi])
    gap = around[allowed + 1 : allowed + 1 + len(phase)] - phase
    k = int(np.argmax(gap))
    return float(np.mod(phase[k] + 0.5 * gap[k], 2 * np.pi))
