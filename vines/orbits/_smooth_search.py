"""Orbits without impacts: from harmonic balance, simulations, orbits of half the period and random states."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.bounds import shown
from vines.dynamics.kernels import constants, room_of
from vines.errors import OrbitNotFound, ParameterError
from vines.model import Word
from vines.orbits._orbit import Orbit
from vines.orbits._smooth_closing import smooth_solved
from vines.orbits._smooth_flow import fly, passages
from vines.orbits._smooth_orbit import assemble_smooth, repeats_sooner, same_smooth, smooth_image

__all__ = ["refine_smooth", "smooth_orbits"]

Floats = npt.NDArray[np.float64]

_RUNS, _SETTLED, _SEEN = 6, 200, 40
"""Runs from random states, forcing periods they are left, and those after which they are looked through."""

_RANDOM = 40
"""Random states from which Newton's method sets out."""

_LARGE = 10.0
"""Size of a motion, in half gaps, from which on a quarter of these is enough."""

_KICKS = (0.03, 0.3)
"""How far, relative to its size, an orbit is moved along its critical direction to come to one that branched off."""

_APART = 1e-6
"""Difference of an orbit to its repetition above which it is one of its own."""


def refine_smooth(word: Word, p: Any, guess: Any) -> Orbit:
    """Return the orbit that Newton's method finds from one at nearby parameters, or from a state at phase 0.

    Raises
    ------
    ParameterError
        If the guess is neither, or nothing holds the mass.
    OrbitNotFound
        If there is none near it.
    """
    _refuse_loose(word, p)
    symmetric = isinstance(guess, Orbit) and guess.symmetric and p.mirrored
    if isinstance(guess, Orbit):
        if guess.word != word:
            raise ParameterError(f"the guess is an orbit of {guess.word}, not of {word}; give one of the same word")
        start = guess.states[0]
    else:
        start = _state_of(word, p, guess)
    converged, start, defect = smooth_solved(word, p, start, symmetric=symmetric)
    if not converged:
        raise OrbitNotFound(
            f"no {word} orbit from this guess at {p}: Newton's method stopped at a defect of {defect:.2g}; give a "
            "nearer guess, such as an orbit at nearby parameters"
        )
    if repeats_sooner(word, passages(p, constants(p), start, word.p)) < _APART:
        raise OrbitNotFound(
            f"no {word} orbit from this guess at {p}: it leads to one of a shorter period; give another"
        )
    return assemble_smooth(word, p, start)


def _state_of(word: Word, p: Any, guess: Any) -> Floats:
    """Return the state at phase 0 of a guess, which may also tell a state and its time, as of an impact."""
    names = [each.name for each in p.system.state]
    try:
        found = np.asarray(guess, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.shape == (1, len(names) + 1) and np.isfinite(found).all():
        t, start = float(found[0, 0]), found[0, 1:]
        return fly(constants(p), start, -t % p.period, p.Omega * t % (2 * np.pi)).end
    if found.shape != (len(names),) or not np.isfinite(found).all():
        raise ParameterError(
            f"the guess is {shown(guess)}; for {word} give an orbit at nearby parameters, or the {len(names)} numbers "
            f"{', '.join(names)} at phase 0 of the forcing"
        )
    return found


def smooth_orbits(word: Word, p: Any) -> tuple[list[Orbit], str]:
    """Return the orbits of a word without impacts that are found, and how they were searched for."""
    _refuse_loose(word, p)
    c = constants(p)
    found: list[Orbit] = []
    tried = 0

    def add(start: Floats, symmetric: bool) -> None:
        nonlocal tried
        tried += 1
        converged, z, _ = smooth_solved(word, p, start, symmetric=symmetric)
        if not converged or any(same_smooth(each, z) for each in found):
            return
        if repeats_sooner(word, passages(p, c, z, word.p)) < _APART:
            return
        found.append(assemble_smooth(word, p, z))
        if not found[-1].symmetric and p.mirrored:
            image = smooth_image(found[-1])
            if not same_smooth(found[-1], image.states[0]):
                found.append(image)

    balanced = _balanced(p) if word.p == 1 else []
    for start in balanced:
        add(start, True)
    for start in _in_wells(p) if word.p == 1 else []:
        add(start, False)
    size = max((float(np.abs(start).max()) for start in balanced or _balanced(p)), default=0.1)
    rng = np.random.default_rng(word.p)
    # Without forcing all comes to rest; motions of a hundred half gaps take a hundred times as many steps.
    share = 0.0 if p.A == 0.0 else 1.0 if size < _LARGE else 0.25
    for start in _returning(word, p, rng, round(share * _RUNS)):
        add(start, False)
    for start in _random(p, rng, size, round(share * _RANDOM)):
        add(start, word.symmetric and p.mirrored and tried % 2 == 0)
    for start in _halves(word, p, found):
        add(start, False)
    return found, (
        f"Newton's method from {tried} starts (harmonic balance, simulations, random states, orbits of half the "
        "period): there may be more"
    )


def _refuse_loose(word: Word, p: Any) -> None:
    """Refuse a mass that nothing holds at its place: its orbits are not isolated."""
    if p.k1 == 0 and p.k3 == 0:
        raise ParameterError(
            f"{word} has no impact, and with k1 = k3 = 0 nothing says where the mass stays: such motions are no "
            "isolated orbits; give a spring, or a word with impacts"
        )


def _balanced(p: Any) -> list[Floats]:
    """Return the states at phase 0 of the motions that balance one harmonic, of the rest where there is no forcing.

    For one harmonic of w the spring is as one of stiffness k1 + 3/4 k3 |w|².
    """
    if p.A == 0.0:
        return [np.zeros(4)]
    turn = p.Omega * p.Omega
    own = 1.0 - turn + 1j * p.lam * p.Omega
    force = p.A * (1.0 + 1j * p.lam * p.Omega)
    # W [own + kappa (mu - own/Omega²)] = force with kappa = k1 + i l2 Omega + 3/4 k3 |W|²
    pull = p.mu - own / turn
    fixed = own + (p.k1 + 1j * p.l2 * p.Omega) * pull
    grows = 0.75 * p.k3 * pull
    cubic = [abs(grows) ** 2, 2.0 * (fixed * grows.conjugate()).real, abs(fixed) ** 2, -(abs(force) ** 2)]
    roots = np.roots(np.trim_zeros(cubic, "f"))
    found = []
    for square in roots[(np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots))) & (roots.real > 0)].real.tolist():
        W = force / (fixed + grows * square)
        X = W * (1.0 - (p.k1 + 1j * p.l2 * p.Omega + 0.75 * p.k3 * square) / turn)
        # motions are the imaginary parts of these phasors times e^{i Omega t}
        rate = 1j * p.Omega
        found.append(np.array([X.imag, (rate * X).imag, (X - W).imag, (rate * (X - W)).imag]))
    return found


def _in_wells(p: Any) -> list[Floats]:
    """Return the states at phase 0 of small motions about the two places where a spring with two wells is at rest."""
    if not (p.k1 < 0 < p.k3):
        return []
    turn = p.Omega * p.Omega
    own = 1.0 - turn + 1j * p.lam * p.Omega
    kappa = -2.0 * p.k1 + 1j * p.l2 * p.Omega
    W = p.A * (1.0 + 1j * p.lam * p.Omega) / (own + kappa * (p.mu - own / turn))
    X, rate, place = W * (1.0 - kappa / turn), 1j * p.Omega, float(np.sqrt(-p.k1 / p.k3))
    about = np.array([X.imag, (rate * X).imag, (X - W).imag, (rate * (X - W)).imag])
    return [about + np.array([0.0, 0.0, side * place, 0.0]) for side in (-1.0, 1.0)]


def _returning(word: Word, p: Any, rng: np.random.Generator, count: int) -> Iterator[Floats]:
    """Yield the states of runs that come back nearest after the period."""
    c, room = constants(p), room_of(p)
    names = [each.name for each in p.system.state]
    for _ in range(count):
        drawn = room.draw(p, rng)
        start = np.array([drawn[name] for name in names])
        points = passages(p, c, start, _SETTLED + _SEEN + word.p)[_SETTLED:]
        away = np.abs(points[word.p :] - points[: -word.p]).max(axis=1)
        if np.isfinite(away).any():
            yield points[int(np.nanargmin(away))]


def _random(p: Any, rng: np.random.Generator, size: float, count: int) -> Iterator[Floats]:
    """Yield random states, up to twice the size of the motions that are known."""
    for _ in range(count):
        yield rng.uniform(-2.0, 2.0) * size * rng.uniform(-1.0, 1.0, len(p.system.state))


def _halves(word: Word, p: Any, found: list[Orbit]) -> list[Floats]:
    """Return orbits of half the period, and symmetric ones found, moved along their critical directions."""
    bases = [each for each in found if each.symmetric and each.max_multiplier > 1.0]
    if word.p % 2 == 0:
        bases += smooth_orbits(Word(f"-/{word.p // 2}T"), p)[0]
    starts: list[Floats] = []
    for base in bases:
        values, vectors = np.linalg.eig(base.jacobians[0])
        wanted = 1.0 if base.word == word else -1.0
        along = np.real(vectors[:, int(np.argmax(np.real(values) * wanted))])
        along *= np.abs(base.states[0]).max() / np.abs(along).max()
        starts += [base.states[0] + sign * kick * along for kick in _KICKS for sign in (-1.0, 1.0)]
    return starts
