"""Run on where nothing repeats, for as long as it takes to tell a slow approach, a torus and chaos apart."""

from __future__ import annotations

import math

from vines.attractors import _verdict as v
from vines.attractors._approach import LARGEST_P, STABLE, comes_to_orbit, nearest_orbit, note_coming
from vines.attractors._coming import note_decay
from vines.attractors._contacts import difference, repetition
from vines.attractors._judge import NEAR, note_drift
from vines.dynamics.kernels import (
    KNOWN_CORRELATION,
    directions,
    drift,
    lyapunov_blocks,
    open_window,
    run_window,
    shift_time,
    spread_of_mean,
)
from vines.dynamics.kernels import rows as col
from vines.kernels import cold_njit, identity, new_matrix, new_vector, njit
from vines.orbits.kernels import contacts

__all__ = ["BLOCKS", "FLAT", "LONGER", "SURE", "follow", "spectrum"]

LONGER = (1, 3, 12)
"""How long to run on where nothing repeats, in units of `watch`: each stage only if those before left it open."""

BLOCKS = 16
"""Blocks in a time `watch` from whose scatter the error of an exponent is taken."""

FLAT = 1.5e-3
"""Largest standard error of an exponent that is called zero."""

SURE = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

LEAST_FREEDOM = 3.0
"""Fewest degrees of freedom of an exponent's error."""

FAR = 0.1
"""Runs that repeat to within this may circle a periodic orbit, slowly coming to it or leaving it."""

LARGEST = 512
"""Largest number of forcing periods over which a repetition is noticed that nobody looked for."""

REPEATS = 1e-6
"""How well it must repeat: a torus comes back to about 1/p after p periods."""

GROWS = 1.05
"""Factor by which the distance from an orbit must grow over the last stage for a run to be still on its way."""


@cold_njit
def follow(c, state, elapsed, watch, cap, tolerance, longest, rows, verdict):
    """Decide what a window left open; `verdict` is that of the window and is filled on.

    Parameters
    ----------
    c : Constants
    state : ndarray
        The run at the end of the window; left as it is.
    elapsed : float
        Length of the window in time.
    watch : float
        Forcing periods of the first stage.
    cap : int
        Most events in one forcing period.
    tolerance, longest
        As for `judge_window`.
    rows : ndarray, shape (m, ROW)
        Room to work in; where it is not enough, more is taken.
    verdict : ndarray, shape (VERDICT,)

    Returns
    -------
    ndarray
        The room, for the next run.
    """
    period = 2.0 * math.pi / c.Omega
    own = new_vector(state.shape[0])
    for k in range(state.shape[0]):
        own[k] = state[k]
    d = len(directions(c))
    Y = identity(d)
    grown = new_matrix(sum(LONGER) * BLOCKS, d + 1)
    filled = 0
    passed = 0.0
    rate, error = 0.0, math.inf
    length, count = 0.0, 0
    verdict[v.REGIME] = v.UNSETTLED
    for stage in range(len(LONGER)):
        shift_time(own, elapsed)
        length = LONGER[stage] * watch * period
        elapsed = length
        passed += LONGER[stage] * watch
        count = open_window(c, own, rows)
        rows, count, code = run_window(c, own, length, cap, rows, count)
        if code != col.COMPLETE:
            verdict[v.REASON] = v.CAPPED_LATER
            return rows
        verdict[v.WATCHED] = verdict[v.RECORDED] + passed
        # The first quarter of the first stage is left to the directions to align.
        skip = 0.25 * length if stage == 0 else 0.0
        blocks = LONGER[stage] * BLOCKS if stage else BLOCKS * 3 // 4
        part = lyapunov_blocks(c, rows, count + 1, skip, length, blocks, Y)
        for b in range(blocks):
            # Growth is booked with the block in which an event falls: a block without one says nothing.
            if part[b, d] > 0.0:
                for j in range(d + 1):
                    grown[filled, j] = part[b, j]
                filled += 1
        rate, error = spectrum(grown, filled, verdict)
        chaotic = rate > SURE * error
        if _beside_orbit(c, rows, count + 1, length, chaotic, stage == len(LONGER) - 1, tolerance, longest, verdict):
            # Counted from the end of the window, not from here.
            verdict[v.REMAINING] += passed
            return rows
        if chaotic:
            verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.CHAOTIC, 1.0, 0.0
            return rows
        if rate < -SURE * error:
            verdict[v.REMAINING] = math.log(1.0 / tolerance) / -rate / period
            verdict[v.REASON], verdict[v.VALUE] = v.DECAYS, longest
            _note_longer(c, rows, count + 1, length, longest, verdict)
            return rows
    event = count - 1
    while event > 0 and rows[event, col.KIND] not in (col.IMPACT, col.STICK):
        event -= 1
    quiet = length - rows[event, col.TIME]
    if quiet > 0.25 * length and rows[count, col.MODE] == 0.0:
        note_drift(verdict, period, drift(c, rows[count, col.A_V2]))
        verdict[v.REMAINING] += passed
        verdict[v.REASON], verdict[v.VALUE] = v.RESTS, quiet / period
    elif _note_longer(c, rows, count + 1, length, longest, verdict):
        verdict[v.REMAINING] = math.nan
    elif error < FLAT:
        verdict[v.REGIME], verdict[v.SETTLED], verdict[v.REMAINING] = v.QUASIPERIODIC, 1.0, 0.0
    else:
        verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.UNDECIDED, rate, error
    return rows


@cold_njit
def spectrum(grown, n, verdict):
    """Write the exponents of growth by n blocks; return the largest and its error, that of a finite run included."""
    d = grown.shape[1] - 1
    time = 0.0
    for b in range(n):
        time += grown[b, d]
    for j in range(d):
        total = 0.0
        for b in range(n):
            total += grown[b, j]
        verdict[v.EXPONENTS + j] = total / time if math.isfinite(total) else -math.inf
    square = 0.0
    for b in range(n):
        square += (grown[b, 0] / grown[b, d] - verdict[v.EXPONENTS]) ** 2
    # A finite run cannot tell rates apart that differ by less than about one over its length.
    error = math.hypot(math.sqrt(square / (n - 1) / n), 1.0 / time) if n > 1 else math.inf
    verdict[v.LYAPUNOV_ERROR] = max(error, _error_told(grown, n, verdict[v.EXPONENTS]))
    verdict[v.KNOWN] = 1.0
    return verdict[v.EXPONENTS], error


@cold_njit
def _note_longer(c, rows, n, length, longest, verdict):
    """Say whether a run repeats after more forcing periods than were looked for, and note after how many."""
    period = 2.0 * math.pi / c.Omega
    most = min(LARGEST, int(0.4 * length / period))
    late = contacts(rows, n, length - 2.5 * most * period)
    for p in range(longest + 1, most + 1):
        lag, passes = repetition(rows, late, p * period)
        if passes > 0 and difference(rows, late, lag, p * period, verdict[v.SCALE], 0) < REPEATS:
            verdict[v.REASON], verdict[v.VALUE], verdict[v.OTHER] = v.LONGER, p, longest
            return True
    return False


@cold_njit
def _error_told(grown, n, rate):
    """Return the standard error of the largest exponent with the correlation of its blocks.

    What few correlated blocks say is uncertain itself: it is the standard deviation of Student's law. The correlation
    comes from the same few blocks, which costs a third of the degrees of freedom; three are left at least.
    """
    if n < 4:
        return math.inf
    d = grown.shape[1] - 1
    series = new_vector(n)
    time = 0.0
    for b in range(n):
        series[b] = grown[b, 0] - rate * grown[b, d]
        time += grown[b, d] / n
    _, together, freedom = spread_of_mean(series)
    freedom = max((freedom + 1.0) * KNOWN_CORRELATION, LEAST_FREEDOM)
    return together / time * math.sqrt(freedom / (freedom - 2.0))


@cold_njit
def _beside_orbit(c, rows, n, length, chaotic, last, tolerance, longest, verdict):
    """Say whether the run comes to a periodic orbit, or is too near one to be on anything else, and note which.

    Its difference to its own repetition is compared between the first and the last quarter; REMAINING counts from the
    end of these rows.
    """
    period = 2.0 * math.pi / c.Omega
    scale = verdict[v.SCALE]
    if chaotic:
        # Chaos that has ended before the end: there the run is next to a stable orbit.
        kept = contacts(rows, n, length - min(2.0 * LARGEST_P * period, 0.25 * length))
        return comes_to_orbit(c, rows, kept, scale, NEAR, tolerance, verdict) == STABLE
    quarter = 0.25 * length
    opening = 1
    while opening < n and rows[opening, col.TIME] <= quarter:
        opening += 1
    early, late = contacts(rows, opening, 0.0), contacts(rows, n, length - quarter)
    least = FAR
    undecided = False
    for p in range(1, longest + 1):
        lag, passes = repetition(rows, late, p * period)
        # Multiples of the period of an orbit that was seen tell no more, unless they repeat much better.
        if passes == 0 or not difference(rows, late, lag, p * period, scale, 0) < least:
            continue
        after = _largest_difference(rows, late, lag, passes, p * period, scale)
        if not after < least:
            continue
        newest = difference(rows, late, lag, p * period, scale, 0)
        oldest = difference(rows, late, lag, p * period, scale, passes - 1)
        earlier, filled = repetition(rows, early, p * period)
        before = _largest_difference(rows, early, earlier, filled, p * period, scale) if filled > 0 else math.inf
        found, largest, _, remaining = False, math.inf, math.inf, math.inf
        if p <= LARGEST_P:
            found, largest, _, remaining = nearest_orbit(c, rows, late, p, lag, scale, tolerance)
        stable = found and largest < 1.0
        # At last, beside an orbit that attracts so little that it does not show.
        if stable and (after < before or (last and after < NEAR and after < GROWS * before)):
            note_coming(verdict, remaining, largest ** (1.0 / p))
            return True
        if not found and newest < 0.5 * oldest:
            note_decay(verdict, newest, p, math.log(oldest / newest) / ((passes - 1.0) * p), tolerance)
            return True
        if p > LARGEST_P:
            # A torus may nearly repeat after many periods.
            continue
        # A run that nears an unstable orbit will leave it again, and one beside a stable orbit may take longer than the
        # quarter to turn about it: that is seen later.
        passing = found and not last and (stable or after < before)
        if (min(before, after) < NEAR and not passing) or (found and last and after > GROWS * before):
            undecided = True
            if after > before:
                verdict[v.REMAINING] = math.log(1.0 / after) / math.log(after / before) * 0.75 * length / period
                verdict[v.REASON] = v.LEAVES
            else:
                verdict[v.REMAINING], verdict[v.REASON] = math.nan, v.STAYS_NEAR
        if found:
            least = 0.2 * after
    return undecided


@njit
def _largest_difference(rows, kept, lag, filled, span, scale):
    """Return the largest difference of any of the newest `filled` repetitions to the one before it."""
    largest = 0.0
    for age in range(filled):
        largest = max(largest, difference(rows, kept, lag, span, scale, age))
    return largest
