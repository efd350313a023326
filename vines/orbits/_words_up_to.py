"""Every word up to a number of impacts and of forcing periods."""

from __future__ import annotations

import itertools

from vines.domains import Whole, stated
from vines.errors import ParameterError
from vines.model import VI_NES, Word

__all__ = ["words_up_to"]

_LONGEST = 12


@stated(ParameterError, length=Whole(least=2, most=_LONGEST), period=Whole(most=100))
def words_up_to(length: int, period: int = 1) -> list[Word]:
    """Return the words that orbits can have, of two mirror images one.

    Parameters
    ----------
    length : int
        Most impacts over the period of the orbit, 2 to 12. There are some 2^length/length words of that length.
    period : int
        Longest period, in forcing periods.

    Returns
    -------
    list of Word
        By period, number of impacts and letters; of a word and its mirror image the one with more L, else the first.
        Words on one wall are left out: no orbit has one (docs/orbits.md, "All orbits of a word").

    Raises
    ------
    ParameterError
        If a number is out of its range.

    Examples
    --------
    >>> [str(word) for word in words_up_to(4)]
    ['LR', 'LLR', 'LLLR', 'LLRR', 'LRLR']
    >>> [str(word) for word in words_up_to(3, period=2)]
    ['LR', 'LLR', 'LR/2T', 'LLR/2T']
    """
    found: list[Word] = []
    for p, n in itertools.product(range(1, period + 1), range(2, length + 1)):
        words = {Word(f"{''.join(letters)}/{p}T") for letters in itertools.product(VI_NES.alphabet, repeat=n)}
        kept = {min(word, word.mirror, key=lambda one: (-one.n, one.letters)) for word in words if word.n and word.m}
        found += sorted(kept, key=lambda one: one.letters)
    return found
