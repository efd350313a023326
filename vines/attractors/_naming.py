"""From the numbers of a verdict to an `Attractor`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._attractor import Attractor
from vines.dynamics.kernels import room_of
from vines.dynamics.runs import STATUS, measures_from
from vines.model import STOPS, VI_NES, Word
from vines.orbits import own_word
from vines.orbits.kernels import STUCK

__all__ = ["attractor_from", "word_of"]

_WORDS: dict[tuple[bytes, int, tuple[tuple[int, ...], ...], int], Word] = {}


def word_of(sides: npt.NDArray[np.int8], p: int, of: Any = None) -> Word:
    """Return the word of the contacts in one repetition of p forcing periods; each is worked out once.

    `sides` is the wall times the number of the ball, the size larger by STUCK where the contact is a complete chatter.
    """
    alike = getattr(of, "alike", ())
    balls = getattr(of, "balls", 0)
    key = (sides.tobytes(), p, alike, balls)
    word = _WORDS.get(key)
    if word is None:
        numbers = np.abs(sides)
        stuck = numbers > STUCK
        numbers = np.where(stuck, numbers - STUCK, numbers).tolist()
        each = [
            STOPS if not side else of.system.letters([side], [ball]) if balls else VI_NES.letters([side])
            for side, ball in zip(sides.tolist(), numbers, strict=True)
        ]
        letters = "".join(name + "*" * sticks for name, sticks in zip(each, stuck.tolist(), strict=True))
        word = _WORDS[key] = own_word(f"{letters}/{p}T", of)
    return word


def attractor_from(
    p: Any,
    verdict: npt.NDArray[np.float64],
    totals: npt.NDArray[np.float64],
    word: Word | None,
    impacts: npt.NDArray[np.void],
    t: float,
    lyapunov: bool,
) -> Attractor:
    """Return the attractor that a verdict describes.

    Parameters
    ----------
    p : Params, or those of another system
        Parameters.
    verdict, totals : ndarray
        As `look` fills them, NUDGED and PERIODS (those before the recording) included.
    word : Word or None
        Its contacts, if it is periodic.
    impacts : structured ndarray
        Recorded impacts.
    t : float
        Time at the start of the run.
    lyapunov : bool
        Whether exponents were asked for.
    """
    value = verdict.tolist()
    regime = int(value[v.REGIME])
    measures = measures_from(p, totals)
    known = lyapunov or bool(value[v.KNOWN])
    room, balls = room_of(p), getattr(p, "balls", 0)
    d = room.layout(p).directions
    exponents = np.full(d, math.nan)
    if known:
        exponents = verdict[v.EXPONENTS : v.EXPONENTS + d].copy()
    multipliers = None
    if not math.isnan(value[v.EXPONENTS + d]):
        multipliers = verdict[v.EXPONENTS + d :][:d] + 1j * verdict[v.EXPONENTS + 2 * d :][:d]
    *at, phase = value[v.FINAL :][:5]
    final = {**room.leave(p, at, phase, value[v.EXPONENTS + 3 * d :]), "phase": phase}
    return Attractor(
        params=p,
        regime=v.REGIMES[regime],
        settled=bool(value[v.SETTLED]),
        word=str(word) if word else None,
        name=word.named(balls if balls > 1 else 0) if word else _unstruck(room.unstruck, value),
        n=word.n if word else None,
        m=word.m if word else None,
        p=word.p if word else None,
        symmetric=bool(value[v.SYMMETRIC]) if word else None,
        sticks=measures.sticks_per_period,
        sticking_share=value[v.STICKING],
        recurrent_sticking=value[v.STICKING] >= v.RECURS or (word is not None and value[v.STICKING] > 0.0),
        measures=measures,
        kinetic_ratio_error=value[v.KINETIC_RATIO_ERROR],
        max_abs_x1_error=value[v.MAX_ABS_X1_ERROR],
        rms_x1_error=value[v.RMS_X1_ERROR],
        impacts=impacts,
        final=final | {"t": t + (value[v.PERIODS] + value[v.RECORDED]) * p.period},
        lyapunov=float(exponents[0]),
        lyapunov_error=value[v.LYAPUNOV_ERROR] if known else math.nan,
        exponents=exponents,
        multipliers=multipliers,
        remaining=value[v.REMAINING],
        transient=value[v.PERIODS],
        recorded=value[v.RECORDED],
        watched=value[v.WATCHED],
        status=STATUS[int(value[v.STATUS])],
        reason=v.reason_text(verdict),
    )


def _unstruck(name: str | None, verdict: list[float]) -> str | None:
    """Return the name of a motion without impacts, if it has settled and has one."""
    if name is None or verdict[v.REGIME] != v.NO_IMPACT or not verdict[v.SETTLED]:
        return None
    periods = int(verdict[v.P])
    # What is at rest repeats after any time.
    return name if periods <= 1 else f"{name}/{periods}T"
