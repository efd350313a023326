"""Words: the sequence of impacts of a periodic orbit, such as ``LR``, ``LLR`` or ``LRLR/2T``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from vines.errors import ParameterError
from vines.model._vi_nes import VI_NES

__all__ = ["Word"]

_LEFT, _RIGHT = (contact.letter for contact in VI_NES.contacts)
_SIGNS = {contact.letter: contact.sign for contact in VI_NES.contacts}
_SHAPE = re.compile(rf"([{VI_NES.alphabet}]+)(?:/([1-9][0-9]*)?T)?")
_SWAP = str.maketrans(dict(VI_NES.mirror.letters))
_HOW = f"write the impacts as letters {' and '.join(VI_NES.alphabet)}, then /pT if p > 1, such as LR, LLR or LRLR/2T"


@dataclass(frozen=True, slots=True, init=False)
class Word:
    """The impacts of one period of a periodic orbit, in canonical rotation.

    L is an impact on the left end of the cavity (w = +1), R on the right (w = -1), in the order of time, over
    p forcing periods. An orbit has no first impact, so that any rotation names the same orbit; the
    lexicographically least one is kept. A repetition stays one: ``LRLR/2T`` is an orbit of least period 2T.

    Parameters
    ----------
    text : str or Word
        The letters, followed by ``/pT`` if p > 1. ``/T`` and ``/1T`` are read as p = 1.

    Attributes
    ----------
    letters : str
        The letters in canonical rotation.
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
                if isinstance(text, str) and re.fullmatch(r"\d+:\d+(/\d*T)?", text):
                    hint = f"n:m/pT does not tell the order of the impacts; {_HOW}"
                raise ParameterError(f"{text!r} is not a word: {hint}")
            letters, p = match[1], int(match[2] or 1)
        object.__setattr__(self, "letters", min(_rotations(letters)))
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
    def name(self) -> str:
        """The type n:m/pT, without /pT if p = 1 (paper, section 3.1)."""
        return _label(self.n, self.m, self.p)

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
                return _label(self.n // times, self.m // times, self.p)
        return self.name

    @property
    def sides(self) -> tuple[int, ...]:
        """The wall of each impact: +1 for L, -1 for R.

        Examples
        --------
        >>> Word("LLR").sides
        (1, 1, -1)
        """
        return tuple(_SIGNS[letter] for letter in self.letters)

    @property
    def mirror(self) -> Word:
        """The word of the mirror image x -> -x, t -> t + T/2 of an orbit."""
        return _word(self.letters.translate(_SWAP), self.p)

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
        half, odd = divmod(len(self.letters), 2)
        return not odd and self.p % 2 == 1 and self.letters[half:] == self.letters[:half].translate(_SWAP)

    def rotations(self) -> tuple[int, ...]:
        """Return the starts from which the letters read the same: (0,) unless they are a repetition.

        Examples
        --------
        >>> Word("LRLR/2T").rotations()
        (0, 2)
        """
        return tuple(k for k, rotated in enumerate(_rotations(self.letters)) if rotated == self.letters)

    def _repeats(self, times: int) -> bool:
        length, rest = divmod(len(self.letters), times)
        return not rest and self.letters[:length] * times == self.letters

    def __len__(self) -> int:
        return len(self.letters)

    def __str__(self) -> str:
        return self.letters if self.p == 1 else f"{self.letters}/{self.p}T"

    def __repr__(self) -> str:
        return f"Word({str(self)!r})"


def _rotations(letters: str) -> list[str]:
    return [letters[k:] + letters[:k] for k in range(len(letters))]


def _word(letters: str, p: int) -> Word:
    return Word(f"{letters}/{p}T")


def _label(n: int, m: int, p: int) -> str:
    return f"{n}:{m}" if p == 1 else f"{n}:{m}/{p}T"
