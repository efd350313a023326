"""Name what a recorded window of a run shows: periodic, quasi-periodic, chaotic, no impact, or not settled yet.

The rules are in docs/dynamics.md, "What a run has settled to".
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from vines.attractors._contacts import contacts, mirror_difference, repetition
from vines.dynamics import _advance as col
from vines.dynamics._constants import Constants
from vines.dynamics._simulate import record as run_on
from vines.dynamics._tangent import exponents_of, lyapunov_blocks, tangent_product
from vines.model import Params, Word

__all__ = ["MAX_P", "Recording", "Verdict", "classify"]

MAX_P = 32
"""Largest number of forcing periods over which a repetition is looked for."""

LONGER = (512, 1536, 6144)
"""Forcing periods run on, after the recording, where nothing repeats: each stage only if those before left it open."""

BLOCK = 32
"""Forcing periods in each of the blocks from whose scatter the error of an exponent is taken."""

FLAT = 1.5e-3
"""Largest standard error of an exponent that is called zero."""

UNSTABLE = 1e-5
"""How far the largest multiplier must lie outside the unit circle for a repeating orbit to be called unstable."""

NEAR = 1e-3
"""Runs that repeat to within this, but not to the tolerance, come to or leave a periodic orbit; they are no torus."""

FOREVER = 1e6
"""A ball that would take more than this many forcing periods to the next wall is called without impact."""


@dataclass(frozen=True, slots=True)
class Recording:
    """A recorded window: rows, its end, and what is needed to run on from there."""

    params: Params
    c: Constants
    rows: npt.NDArray[np.float64]
    length: float
    state: npt.NDArray[np.float64]
    cap: int

    @property
    def speed(self) -> float:
        """Scale of velocities and displacements, at least 1e-3 so that rest is no special case."""
        hits = self.rows[self.rows[:, col.KIND] == col.IMPACT]
        return max(float(np.max(np.abs(hits[:, [col.V1, col.V2]]), initial=0.0)), 1e-3)


@dataclass(slots=True)
class Verdict:
    """What was found; the fields are those of `Attractor`."""

    regime: str
    settled: bool
    word: str | None = None
    name: str | None = None
    n: int | None = None
    m: int | None = None
    p: int | None = None
    symmetric: bool | None = None
    remaining: float = 0.0
    reason: str = ""
    unstable: bool = False
    exponents: npt.NDArray[np.float64] = field(default_factory=lambda: np.full(4, np.nan))
    lyapunov: float = math.nan
    lyapunov_error: float = math.nan
    multipliers: npt.NDArray[np.complex128] | None = None


@dataclass(frozen=True, slots=True)
class _Match:
    """How well the contacts repeat after p periods: lag in contacts, and the difference of each repetition."""

    p: int
    lag: int
    blocks: npt.NDArray[np.float64]


def classify(recording: Recording, tolerance: float) -> Verdict:
    """Name what a recording shows.

    Parameters
    ----------
    recording : Recording
        The window; at least two forcing periods, or only p = 1 could show.
    tolerance : float
        Largest distance from the periodic orbit (velocities relative to the largest speed, times absolute).
    """
    kept = contacts(recording.rows, len(recording.rows), 0.0)
    if len(kept) == 0:
        return _without_impact(recording, tolerance)
    scale = recording.speed
    best: _Match | None = None
    for p in range(1, min(MAX_P, int(recording.length / recording.params.period / 2 + 1e-9)) + 1):
        match = _match(recording.rows, kept, p, p * recording.params.period, scale)
        if match is None:
            continue
        # A run within the tolerance of its orbit repeats to twice that, and to less after 2 p periods where a
        # multiplier is near -1: with a tighter bound here the orbit would be named with twice its period.
        if match.blocks[-1] <= 2.5 * tolerance:
            return _periodic(recording, kept, match, scale, tolerance)
        if best is None or match.blocks[-1] < 0.5 * best.blocks[-1]:
            best = match
    return _not_repeating(recording, best, scale, tolerance)


def _match(
    rows: npt.NDArray[np.float64], kept: npt.NDArray[np.int64], p: int, span: float, scale: float
) -> _Match | None:
    blocks = np.empty(len(kept))
    lag, filled = repetition(rows, kept, span, scale, blocks)
    return _Match(p, lag, blocks[:filled]) if filled else None


def _periodic(
    recording: Recording, kept: npt.NDArray[np.int64], match: _Match, scale: float, tolerance: float
) -> Verdict:
    """Judge a run that repeats: it may still be creeping towards its orbit, or sit on an unstable one."""
    rows, period = recording.rows, recording.params.period
    product = tangent_product(recording.c, rows, kept[-1 - match.lag], kept[-1])
    multipliers = np.linalg.eigvals(product).astype(np.complex128)
    sizes = np.abs(multipliers)
    span = rows[kept[-1 - match.lag] + 1 : kept[-1] + 1]
    if np.any(span[:, col.KIND] == col.STICK):
        # After a merge only the common motion is left, two directions of four; what else shows is rounding.
        dead = np.argsort(sizes, kind="stable")[:2]
        multipliers[dead] = sizes[dead] = 0.0
    order = np.argsort(-sizes, kind="stable")
    multipliers, sizes = multipliers[order], sizes[order]
    with np.errstate(divide="ignore"):
        exponents = np.log(sizes) / (match.p * period)
    largest = float(sizes[0])
    found = Verdict("periodic", True, exponents=exponents, multipliers=multipliers)
    found.lyapunov, found.lyapunov_error = float(exponents[0]), 0.0
    last = float(match.blocks[-1])
    if largest > 1.0 + UNSTABLE:
        found.regime, found.settled, found.unstable = "unsettled", False, True
        found.remaining = match.p * math.log(NEAR / max(last, 1e-15)) / math.log(largest)
        found.reason = f"on an unstable periodic orbit: its largest multiplier is {largest:.6g}"
        return found
    # The difference of one repetition is |1 - multiplier| of the distance that is left.
    distance = last / float(np.min(np.abs(1.0 - multipliers))) if largest < 1.0 else math.inf
    if distance > tolerance and last > 1e-12:
        found.regime, found.settled = "unsettled", False
        found.remaining = (
            match.p * math.log(distance / tolerance) / -math.log(largest) if math.isfinite(distance) else math.inf
        )
        found.reason = f"still {distance:.2g} from a periodic orbit whose largest multiplier is {largest:.6g}"
        return found
    letters = "".join("L" if rows[i, col.SIDE] > 0 else "R" for i in kept[len(kept) - match.lag :])
    word = Word(letters if match.p == 1 else f"{letters}/{match.p}T")
    found.word, found.name = str(word), word.name
    found.n, found.m, found.p = word.n, word.m, word.p
    mirrored = mirror_difference(rows, kept, match.lag, match.p * period, scale)
    found.symmetric = bool(mirrored <= 1e3 * max(tolerance, distance))
    return found


def _without_impact(recording: Recording, tolerance: float) -> Verdict:
    """Judge a run without impacts: a drifting ball will hit a wall one day; the oscillator's start must die out."""
    p, last = recording.params, recording.rows[-1]
    exponents = np.array([0.0, 0.0, -0.5 * p.lam, -0.5 * p.lam])
    found = Verdict("no_impact", True, exponents=exponents, lyapunov=0.0, lyapunov_error=0.0)
    drift = abs(float(last[col.A_V2])) if last[col.MODE] == 0 else 0.0
    periods = 2.0 / (drift * p.period) if drift > 0 else math.inf
    if periods < FOREVER:
        found.regime, found.settled, found.remaining = "unsettled", False, periods
        found.reason = "no impact while recorded, but the ball drifts towards a wall"
        return found
    response = recording.c.free
    phase = float(last[col.PHASE])
    q = complex(response.qr, response.qi) * complex(math.cos(phase), math.sin(phase))
    excess = math.hypot(float(last[col.X1]) - q.real, float(last[col.V1]) + p.Omega * q.imag)
    if excess > max(tolerance, 1e-15):
        found.settled = False
        found.remaining = math.log(excess / tolerance) / (0.5 * p.lam * p.period) if p.lam > 0 else math.inf
        found.reason = f"the oscillator is still {excess:.2g} from its steady motion"
    return found


def _not_repeating(recording: Recording, best: _Match | None, scale: float, tolerance: float) -> Verdict:
    """Tell a slow approach, a torus and chaos apart, by running on for as long as it takes, within LONGER."""
    period = recording.params.period
    state, Y = recording.state.copy(), np.eye(4)
    found = Verdict("unsettled", False, remaining=math.nan)
    blocks: list[npt.NDArray[np.float64]] = []
    elapsed = recording.length
    for stage, periods in enumerate(LONGER):
        col.shift_time(state, elapsed)
        elapsed = length = periods * period
        rows, status = run_on(recording.c, state, length, recording.cap, 4 * periods)
        if status != "complete":
            found.reason = "more events in a forcing period than allowed while running on"
            return found
        # The first quarter of the first stage is left to the directions to align.
        skip = 0.25 * length if stage == 0 else 0.0
        count = round((length - skip) / (BLOCK * period))
        blocks.append(lyapunov_blocks(recording.c, rows, len(rows), skip, length, count, Y))
        grown = np.concatenate(blocks)
        found.exponents, errors = exponents_of(grown)
        found.lyapunov = float(found.exponents[0])
        # A finite run cannot tell rates apart that differ by less than about one over its length.
        found.lyapunov_error = math.hypot(float(errors[0]), 1.0 / float(grown[:, 4].sum()))
        if stage == 0 and best and _coming_or_leaving(recording, rows, length, best, scale, tolerance, found):
            return found
        if found.lyapunov > 3.0 * found.lyapunov_error:
            found.regime, found.settled, found.remaining = "chaotic", True, 0.0
            return found
        if found.lyapunov < -3.0 * found.lyapunov_error:
            found.remaining = math.log(1.0 / tolerance) / -found.lyapunov / period
            found.reason = "disturbances decay, but no repetition shows yet"
            return found
    if found.lyapunov_error < FLAT:
        found.regime, found.settled, found.remaining = "quasiperiodic", True, 0.0
    else:
        found.reason = f"its exponent {found.lyapunov:.2g} +- {found.lyapunov_error:.2g} is not told from 0"
    return found


def _coming_or_leaving(
    recording: Recording,
    rows: npt.NDArray[np.float64],
    length: float,
    best: _Match,
    scale: float,
    tolerance: float,
    found: Verdict,
) -> bool:
    """Say whether the run comes to, or leaves, a periodic orbit, and if so note how long that will take."""
    periods = LONGER[0]
    kept = contacts(rows, len(rows), length - recording.length)
    later = _match(rows, kept, best.p, best.p * recording.params.period, scale) if len(kept) > 1 else None
    before = float(np.max(best.blocks))
    after = float(np.max(later.blocks)) if later else math.inf
    chaotic = found.lyapunov > 3.0 * found.lyapunov_error
    if min(before, after) >= NEAR and (chaotic or after >= 0.5 * before):
        return False
    if after < 0.5 * before:
        rate = math.log(before / max(after, 1e-15)) / periods
        left = float(best.blocks[-1]) / -math.expm1(-rate * best.p)
        found.remaining = max(math.log(left / tolerance) / rate, 0.0)
        found.reason = f"still comes to a periodic orbit: {math.exp(-rate):.6g} of the distance is left each period"
        return True
    found.reason = "near a periodic orbit, neither settled on it nor clearly leaving it"
    if before < after < math.inf:
        found.remaining = math.log(1.0 / after) / (math.log(after / before) / periods) if after < 1.0 else 0.0
        found.reason = "leaves an unstable periodic orbit"
    return True
