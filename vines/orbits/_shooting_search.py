"""Orbits whose flights no closed form gives: from simulations, and from those of the VI-NES as the springs grow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics.kernels import room_of
from vines.model import PARAMETER_NAMES, STATE_NAMES, V1, X1, Params, Word
from vines.orbits._assemble import assemble
from vines.orbits._general import proper, same
from vines.orbits._orbit import Orbit
from vines.orbits._seeds import stretches
from vines.orbits._shooting import shot

__all__ = ["gather_shots", "of_the_vi_nes"]

Floats = npt.NDArray[np.float64]

_SPRINGS = ("k1", "k3", "l2", "alpha")
"""Parameters without which a system is the VI-NES."""

_LEAST = 1.0 / 256.0
"""Smallest step, as a part of the springs, in which an orbit is followed from that of the VI-NES."""


def gather_shots(word: Word, p: Any, likes: list[Orbit]) -> tuple[list[Orbit], int]:
    """Return the orbits that simulations, and those of the VI-NES in `likes`, lead to, and from how many starts."""
    found: list[Orbit] = []
    tried = 0
    for start in _starts(word, p, likes):
        tried += 1
        converged, t, _, states = shot(word, p, *start)
        if not (converged and proper(word, word.p * p.period, t, states)):
            continue
        if not any(same(known, t, states) for known in found):
            found.append(assemble(word, p, t, states))
    return found, tried


def _starts(word: Word, p: Any, likes: list[Orbit]) -> Iterator[tuple[Floats, Floats]]:
    for times, hits in stretches(word, p):
        yield times, np.stack([hits[name] for name in (*STATE_NAMES, *room_of(p).beside)], axis=1)
    for orbit in likes:
        followed = _with_springs(word, p, orbit)
        if followed is not None:
            yield followed


def of_the_vi_nes(p: Any) -> Params:
    """Return the parameters of the same system without its springs."""
    values = p.as_dict()
    return Params(**{name: values[name] for name in PARAMETER_NAMES})


def _with_springs(word: Word, p: Any, orbit: Orbit) -> tuple[Floats, Floats] | None:
    """Return times and states of an orbit of the VI-NES followed as the springs grow to their own, None if lost."""
    values = p.as_dict()
    t, states, done, step = orbit.t, orbit.states, 0.0, 0.25
    grows = [name for name in _SPRINGS if name in values]
    if room_of(p).beside:
        # A mass beside the ball moves as the oscillator drives it, and grows from nothing.
        grows = ["mu_n"]
        states = np.column_stack([states, states[:, [X1, V1]]])
        converged, t, _, states = shot(word, p.replace(mu_n=0.0), t, states)
        if not converged:
            return None
    while done < 1.0:
        share = min(done + step, 1.0)
        there = p.replace(**{name: share * values[name] for name in grows})
        converged, near, _, other = shot(word, there, t, states)
        if converged and proper(word, word.p * p.period, near, other):
            t, states, done, step = near, other, share, 2 * step
        elif step < _LEAST:
            return None
        else:
            step *= 0.5
    return t, states
