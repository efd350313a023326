"""Words: the sequence of impacts of a periodic orbit, such as ``LR``, ``LLR`` or ``LRLR/2T``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from vines.bounds import shown
from vines.errors import ParameterError
from vines.model._letters import NOTHING, STICKS, STOPS, ball_of, impacts, renamed, roles, rotated
from vines.model._system import System
from vines.model._vi_nes import VI_NES

__all__ = ["Word", "not_alone", "of_moderate_length", "word_for"]

_LEFT, _RIGHT = (contact.letter for contact in VI_NES.contacts)
_SIGNS = {contact.letter: contact.sign for contact in VI_NES.contacts} | {STOPS: 0, NOTHING: 0}
_SHAPE = re.compile(
    rf"((?:[{VI_NES.alphabet}]\*?|{STOPS})+|(?:[{VI_NES.alphabet}][1-9]\*?)+|{NOTHING}|0:0)(?:/([1-9][0-9]*)?T)?"
)
_LONGEST = 5000
"""Most impacts of a word, and most forcing periods: what a simulation settles to may have many."""

_SEARCHED = 200
"""The same of a word of which an orbit is asked for."""
_SWAP = str.maketrans(dict(VI_NES.mirror.letters))
_HOW = (
    f"write the impacts as letters {' and '.join(VI_NES.alphabet)}, each with the number of its ball where there are "
    "several and a star where it sticks, or - for none, then /pT if p > 1, such as LR, LLR, LRLR/2T, L*R or L1L2R1R2"
)


@dataclass(frozen=True, slots=True, init=False)
class Word:
    """The impacts of one period of a periodic orbit, in canonical rotation.

    L is an impact on the left end of the cavity (w = +1), R on the right (w = -1), in the order of time, over
    p forcing periods. An orbit has no first impact, so that any rotation names the same orbit; the
    lexicographically least one is kept. A repetition stays one: ``LRLR/2T`` is an orbit of least period 2T.

    A star behind a letter is a complete chatter: all impacts of the ball on that wall since it last hit elsewhere or
    was let go, infinitely many, after which it sticks to the wall until the contact force vanishes. They count as one
    contact at the time of the first: ``L*R*`` is a 1:1 orbit that sticks on both sides, ``LR`` one that never does.

    With friction a ball may stop in mid-cavity: ``s``, ``LsRs``. A stop counts as a contact, but as no impact.

    Without any impact it is ``-``, ``-/3T``, of the type 0:0; ``0:0`` is read as that. What stands for an impact there,
    as a contact at no wall, is the passage through phase 0 of the forcing.

    Where a system has several balls, each letter has the number of the ball that hits: ``L1L2R1R2``. A system with one
    ball writes no number.

    Parameters
    ----------
    text : str or Word
        The letters, followed by ``/pT`` if p > 1. ``/T`` and ``/1T`` are read as p = 1.

    Attributes
    ----------
    letters : str
        The letters in canonical rotation, with the numbers of balls if there are several.
    p : int
        Least period of the orbit, in forcing periods.

    Raises
    ------
    ParameterError
        If the text is not such a word.

    Examples
    --------
    >>> Word("RLL")
    Word('LLR')
    >>> w = Word("RLRL/2T")
    >>> str(w), w.name, w.alias, w.n, w.m, w.p
    ('LRLR/2T', '2:2/2T', '1:1/2T', 2, 2, 2)
    >>> Word("LLR").mirror
    Word('LRR')
    >>> Word("R2L1L2R1").letters, Word("L1L2R2L1R1").name
    ('L1L2R1R2', '2:1|1:1')
    >>> w = Word("RL*")
    >>> str(w), w.name, w.sticks
    ('L*R', '1:1', (True, False))
    >>> Word("0:0/3T"), Word("-/3T").name
    (Word('-/3T'), '0:0/3T')
    """

    letters: str
    p: int

    def __init__(self, text: str | Word) -> None:
        if isinstance(text, Word):
            letters, p = text.letters, text.p
        else:
            match = _SHAPE.fullmatch(text) if isinstance(text, str) else None
            if match is None:
                hint = _HOW
                if isinstance(text, str) and re.fullmatch(r"(?!0:0)\d+:\d+(/\d*T)?", text):
                    hint = f"n:m/pT does not tell the order of the impacts; {_HOW}"
                raise ParameterError(f"{shown(text)} is not a word: {hint}")
            letters, p = (
                match[1] if match[1] != "0:0" else NOTHING,
                int(match[2] or 1) if len(match[2] or "") < 6 else _LONGEST + 1,
            )
            if len(impacts(letters)) > _LONGEST or p > _LONGEST:
                raise ParameterError(_too_long(text, _LONGEST))
            if STICKS in letters:
                _refuse_split_chatter(text, letters)
        object.__setattr__(self, "letters", min(rotated(letters)))
        object.__setattr__(self, "p", p)

    @property
    def n(self) -> int:
        """Impacts on the left end over pT."""
        return self.letters.count(_LEFT)

    @property
    def m(self) -> int:
        """Impacts on the right end over pT."""
        return self.letters.count(_RIGHT)

    @property
    def balls(self) -> tuple[int, ...]:
        """The number of the ball of each impact; 0 where balls have no numbers.

        Examples
        --------
        >>> Word("L1L2R1R2").balls, Word("LR").balls
        ((1, 2, 1, 2), (0, 0))
        """
        return tuple(ball_of(each) for each in impacts(self.letters))

    @property
    def name(self) -> str:
        """The type n:m/pT, without /pT if p = 1 (paper, section 3.1); of each ball if there are several: 1:1|2:1."""
        return self.named(max(self.balls))

    def named(self, balls: int) -> str:
        """Return the type with so many balls, the last of which need not hit.

        Examples
        --------
        >>> Word("L1R1").named(2), Word("LR").named(0)
        ('1:1|0:0', '1:1')
        """
        return _label(self._counts(1, balls), self.p)

    def _counts(self, times: int, balls: int) -> list[tuple[int, int]]:
        """Return the impacts on both ends over a part of the period, for each ball."""
        own = range(1, balls + 1) if balls else (0,)
        hits = list(zip(self.sides, self.balls, strict=True))
        return [(hits.count((1, ball)) // times, hits.count((-1, ball)) // times) for ball in own]

    @property
    def alias(self) -> str:
        """The paper's label, which counts the impacts of a period-doubled orbit over T, not over pT.

        The paper writes 1:1/2T for what its own definition calls 2:2/2T. Where the letters are not such a
        repetition the alias is the name.

        Examples
        --------
        >>> [Word(w).alias for w in ("LR", "LLRLLR/2T", "LRLRLRLR/4T", "LLRLR/2T")]
        ['1:1', '2:1/2T', '1:1/4T', '3:2/2T']
        """
        for times in range(self.p, 1, -1):
            if self.p % times == 0 and self._repeats(times):
                return _label(self._counts(times, max(self.balls)), self.p)
        return self.name

    @property
    def sides(self) -> tuple[int, ...]:
        """The wall of each impact: +1 for L, -1 for R; 0 for a stop in mid-cavity.

        Examples
        --------
        >>> Word("LLR").sides
        (1, 1, -1)
        """
        return tuple(_SIGNS[each[0]] for each in impacts(self.letters))

    @property
    def sticks(self) -> tuple[bool, ...]:
        """Whether each contact is a complete chatter that ends in sticking.

        Examples
        --------
        >>> Word("L*RR").sticks
        (True, False, False)
        """
        return tuple(each.endswith(STICKS) for each in impacts(self.letters))

    @property
    def sticking(self) -> bool:
        """Whether the ball sticks somewhere in the orbit."""
        return STICKS in self.letters

    @property
    def unstruck(self) -> bool:
        """Whether nothing is hit in the orbit."""
        return self.letters == NOTHING

    @property
    def mirror(self) -> Word:
        """The word of the mirror image x -> -x, t -> t + T/2 of an orbit."""
        return _word(self.letters.translate(_SWAP), self.p)

    @property
    def doubled(self) -> Word:
        """The word of an orbit of this word that is gone through twice.

        Examples
        --------
        >>> Word("LR/3T").doubled
        Word('LRLR/6T')
        """
        return _word(self.letters * 2, 2 * self.p)

    @property
    def symmetric(self) -> bool:
        """Whether an orbit of this word can be its own mirror image.

        The mirror image shifts time by an odd number of half periods; applied twice it must give the orbit
        again, so that p is odd, the shift is pT/2, and the second half of the letters is the first one with
        L and R swapped.

        Examples
        --------
        >>> [Word(w).symmetric for w in ("LR", "LLRR", "LLR", "LRLR/2T", "LR/3T")]
        [True, True, False, False, True]
        """
        half = len(self.letters) // 2
        if self.unstruck:
            return self.p % 2 == 1
        return len(self) % 2 == 0 and self.p % 2 == 1 and self.letters[half:] == self.letters[:half].translate(_SWAP)

    def relabelled(self, alike: Iterable[Iterable[int]]) -> tuple[Word, dict[int, int]]:
        """Return the least word that renaming equal balls gives, and the new number of each of them that hits.

        Parameters
        ----------
        alike : iterable of iterables of int
            Numbers of balls that are equal to each other, group by group.

        Examples
        --------
        >>> Word("L2L1R1R2").relabelled([(1, 2)])
        (Word('L1L2R2R1'), {2: 1, 1: 2})
        """
        groups = [sorted(group) for group in alike]
        letters, names = min((renamed(each, groups) for each in rotated(self.letters)), key=lambda each: each[0])
        return _word(letters, self.p), names

    def shifted(self, alike: Iterable[Iterable[int]]) -> dict[int, int]:
        """Return how equal balls change roles from one forcing period to the next; empty if they don't.

        Examples
        --------
        >>> Word("L1L2R2R1L2L1R1R2/2T").shifted([(1, 2)])
        {1: 2, 2: 1}
        >>> Word("L1L2R1R2").shifted([(1, 2)])
        {}
        """
        length, rest = divmod(len(self), self.p)
        if rest or self.p == 1:
            return {}
        each = impacts(self.letters)
        return roles(each, each[length:] + each[:length], [set(group) for group in alike])

    def rotations(self) -> tuple[int, ...]:
        """Return the starts from which the letters read the same: (0,) unless they are a repetition.

        Examples
        --------
        >>> Word("LRLR/2T").rotations()
        (0, 2)
        """
        return tuple(k for k, each in enumerate(rotated(self.letters)) if each == self.letters)

    def _repeats(self, times: int) -> bool:
        return len(self) % times == 0 and self.letters[: len(self.letters) // times] * times == self.letters

    def __len__(self) -> int:
        return len(self.sides)

    def __str__(self) -> str:
        return self.letters if self.p == 1 else f"{self.letters}/{self.p}T"

    def __repr__(self) -> str:
        return f"Word({str(self)!r})"


def of_moderate_length(word: Word) -> Word:
    """Return a word of which orbits can be searched.

    Raises
    ------
    ParameterError
        If it is too long.
    """
    if len(word) > _SEARCHED or word.p > _SEARCHED:
        raise ParameterError(_too_long(str(word), _SEARCHED))
    return word


def _too_long(text: str, most: int) -> str:
    return f"{shown(text)} is too long a word; allowed are {most} impacts over {most}T"


def word_for(text: str | Word, system: System, *, sticking: bool = True) -> Word:
    """Return a word of a system; one numbered ball may also do without its number.

    Parameters
    ----------
    text : str or Word
    system : System
    sticking : bool
        Whether the orbit may stick.

    Raises
    ------
    ParameterError
        If the text is no word, has impacts that the system does not have, or a star where none may be.

    Examples
    --------
    >>> word_for("L1R1", VI_NES)
    Traceback (most recent call last):
    vines.errors.ParameterError: 'L1R1' is not a word of the system 'vi_nes', which has the impacts L, R
    """
    word = of_moderate_length(Word(text))
    if word.unstruck:
        if not system.smooth:
            raise ParameterError(not_alone(word, system))
        return word
    known = [contact.letter for contact in system.contacts]
    if system.stops:
        known.append(STOPS)
    if system.balls == 1:
        known += sorted({letter[0] for letter in known})
    if not {each.rstrip(STICKS) for each in impacts(word.letters)} <= set(known):
        raise ParameterError(
            f"{str(text)!r} is not a word of the system {system.name!r}, which has the impacts {', '.join(known)}"
        )
    if word.sticking and not sticking:
        raise ParameterError(f"{str(text)!r} sticks, for which this is not made; give a word without a star")
    return word


def not_alone(word: Word, system: System) -> str:
    """Say why a system has no orbit of a word without impacts."""
    return (
        f"{word} has no impact, and in the system {system.name!r} nothing says where a ball stays that hits nothing: "
        "such motions are no isolated orbits; give a word with impacts"
    )


def _refuse_split_chatter(text: str, letters: str) -> None:
    """Refuse an impact on the wall of a complete chatter just before it, which belongs to that chatter."""
    before: dict[int, str] = {}
    for each in impacts(letters) * 2:
        ball = ball_of(each)
        if before.get(ball) == each.removesuffix(STICKS) != each:
            raise ParameterError(
                f"{text!r} is not a word: the impact {before[ball]} just before {each} is part of that chatter, which "
                f"has all impacts on its wall since the last one elsewhere or the last release; write {each} alone"
            )
        before[ball] = each


def _word(letters: str, p: int) -> Word:
    return Word(f"{letters}/{p}T")


def _label(counts: Iterable[tuple[int, int]], p: int) -> str:
    types = "|".join(f"{n}:{m}" for n, m in counts)
    return types if p == 1 else f"{types}/{p}T"
