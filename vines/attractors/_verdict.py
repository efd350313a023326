"""What is noted of a run, as numbers that kernels can fill in, and the words that belong to them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["REGIMES", "VERDICT", "reason_text"]

# Entries of a verdict; those that do not apply are nan or 0.
(
    REGIME,
    SETTLED,
    P,
    LAG,
    LEFT,
    RIGHT,
    SYMMETRIC,
    REMAINING,
    UNSTABLE,
    REASON,
    VALUE,
    OTHER,
    LYAPUNOV_ERROR,
    KNOWN,
    SCALE,
    KINETIC_RATIO_ERROR,
    MAX_ABS_X1_ERROR,
    RMS_X1_ERROR,
    STATUS,
    RECORDED,
    PERIODS,
    NUDGED,
    STICKING,
    NEXT,
    WATCHED,
) = range(25)
FINAL = 25
EXPONENTS = 30
"""First of d exponents, after which come d real and d imaginary parts of multipliers, and what else of the final state
there is: d numbers are in a disturbance."""

VERDICT = 42
"""Length for the four numbers of a disturbance of the VI-NES."""

UNSETTLED, PERIODIC, QUASIPERIODIC, CHAOTIC, NO_IMPACT, OPEN = range(6)
REGIMES = ("unsettled", "periodic", "quasiperiodic", "chaotic", "no_impact")
"""Names of the regimes by number; OPEN is what a window leaves to a longer run."""

STAYS, WAITS, IS_FREED = range(3)
"""What becomes of a run after a look, under NEXT: it is taken as it is, waits, or is pushed off an unstable orbit."""

RECURS = 0.9
"""Share of the forcing periods with sticking from which it counts as recurrent where the motion never repeats."""

(
    NOTHING,
    ON_UNSTABLE,
    CREEPS,
    DRIFTS,
    RESTS,
    RINGS,
    DECAYS,
    COMES,
    STAYS_NEAR,
    LEAVES,
    UNDECIDED,
    CAPPED,
    CAPPED_LATER,
    CONSERVES,
    REMEMBERS,
    LONGER,
) = range(16)

_TEXTS = {
    NOTHING: "",
    ON_UNSTABLE: "on an unstable periodic orbit: its largest multiplier is {value:.6g}",
    CREEPS: "still {value:.2g} from a periodic orbit whose largest multiplier is {other:.6g}",
    DRIFTS: "no impact while recorded, but the ball drifts towards a wall",
    RESTS: "the ball is nearly at rest: no impact for the last {value:.4g} forcing periods",
    RINGS: "the oscillator is still {value:.2g} from its steady motion",
    DECAYS: "disturbances decay, but no repetition of p <= {value:.0f} periods shows yet; largest_p is for longer ones",
    COMES: "still comes to a periodic orbit: {value:.6g} of the distance is left each period",
    STAYS_NEAR: "near a periodic orbit, neither settled on it nor clearly leaving it",
    LEAVES: "leaves an unstable periodic orbit",
    UNDECIDED: "its exponent {value:.2g} +- {other:.2g} is not told from 0",
    CAPPED: "more events in a forcing period than the cap allows",
    CAPPED_LATER: "more events in a forcing period than allowed while running on",
    CONSERVES: "nothing is lost, by damping or in impacts: there is no attractor",
    LONGER: "repeats after p = {value:.0f} periods, p <= {other:.0f} was looked for; largest_p = {value:.0f} names it",
    REMEMBERS: "no standard errors: the motion remembers longer than {value:.4g} forcing periods can tell",
}


def reason_text(verdict: npt.NDArray[np.float64]) -> str:
    """Say in words why a run is called unsettled, or what was noted on the way; empty if nothing."""
    text = _TEXTS[int(verdict[REASON])].format(value=verdict[VALUE], other=verdict[OTHER])
    if not text and not math.isnan(verdict[NUDGED]):
        return "nudged: " + _TEXTS[ON_UNSTABLE].format(value=verdict[NUDGED])
    return text
