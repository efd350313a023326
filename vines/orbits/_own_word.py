"""The word by which a system calls an orbit: balls that are equal have no order, and one ball alone has no number."""

from __future__ import annotations

from typing import Any

from vines.errors import ParameterError
from vines.model import STOPS, Word, not_alone, of_moderate_length

__all__ = ["own_word", "whole_word"]


def own_word(word: str | Word, p: Any) -> Word:
    """Return a word as the system of some parameters writes it.

    Raises
    ------
    ParameterError
        If it is not a word.

    Examples
    --------
    >>> from vines.systems import Parallel
    >>> own_word("L2L1R2R1", Parallel(mu=(0.01, 0.01), A=0.02)), own_word("L1R1", Parallel(mu=(0.01,), A=0.02))
    (Word('L1L2R1R2'), Word('LR'))
    """
    word = Word(word)
    if getattr(p, "balls", 0) == 1 and set(word.balls) == {1}:
        return Word(f"{word.letters.replace('1', '')}/{word.p}T")
    alike = getattr(p, "alike", ())
    return word.relabelled(alike)[0] if alike and any(word.balls) else word


def whole_word(word: str | Word, p: Any) -> Word:
    """Return the same of a word in which each ball hits: the motion of one that does not is not determined.

    Raises
    ------
    ParameterError
        If it is not a word, or not of the balls of the system.

    Examples
    --------
    >>> from vines.systems import Parallel
    >>> whole_word("L2R2", Parallel(mu=(0.01, 0.02), A=0.02))
    Traceback (most recent call last):
    vines.errors.ParameterError: L2R2 has impacts of ball 2, the system has balls 1 … 2; give a word in which each hits
    """
    word = of_moderate_length(own_word(word, p))
    if word.unstruck and not p.system.smooth:
        raise ParameterError(not_alone(word, p.system))
    if STOPS in word.letters and not p.system.stops:
        raise ParameterError(f"{word} has stops, and a ball of the system {p.system.name!r} never stops in mid-cavity")
    balls = getattr(p, "balls", 1)
    numbers = sorted(set(word.balls))
    if numbers != (list(range(1, balls + 1)) if balls > 1 else [0]):
        who = ", ".join(f"ball {number}" for number in numbers if number) or "a ball without number"
        has = f"balls 1 … {balls}" if balls > 1 else "one ball"
        raise ParameterError(f"{word} has impacts of {who}, the system has {has}; give a word in which each hits")
    return word
