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
    BEST_P,
    BEST_LAST,
    BEST_WORST,
    BEST_FIRST,
    BEST_FILLED,
    SCALE,
    KINETIC_RATIO_ERROR,
    MAX_ABS_X1_ERROR,
    RMS_X1_ERROR,
    STATUS,
    RECORDED,
    PERIODS,
    NUDGED,
) = range(27)
EXPONENTS = 27
MULTIPLIERS_RE = 31
MULTIPLIERS_IM = 35
FINAL = 39
VERDICT = 44

UNSETTLED, PERIODIC, QUASIPERIODIC, CHAOTIC, NO_IMPACT, OPEN = range(6)
REGIMES = ("unsettled", "periodic", "quasiperiodic", "chaotic", "no_impact")
"""Names of the regimes by number; OPEN is what a window leaves to a longer run."""

(
    NOTHING,
    ON_UNSTABLE,
    CREEPS,
    DOUBLES,
    DRIFTS,
    RINGS,
    DECAYS,
    COMES,
    STAYS_NEAR,
    LEAVES,
    UNDECIDED,
    CAPPED,
    CAPPED_LATER,
) = range(13)

_TEXTS = {
    NOTHING: "",
    ON_UNSTABLE: "on an unstable periodic orbit: its largest multiplier is {value:.6g}",
    CREEPS: "still {value:.2g} from a periodic orbit whose largest multiplier is {other:.6g}",
    DOUBLES: "still {value:.2g} from repeating in half the period: too near a period doubling to say",
    DRIFTS: "no impact while recorded, but the ball drifts towards a wall",
    RINGS: "the oscillator is still {value:.2g} from its steady motion",
    DECAYS: "disturbances decay, but no repetition shows yet",
    COMES: "still comes to a periodic orbit: {value:.6g} of the distance is left each period",
    STAYS_NEAR: "near a periodic orbit, neither settled on it nor clearly leaving it",
    LEAVES: "leaves an unstable periodic orbit",
    UNDECIDED: "its exponent {value:.2g} +- {other:.2g} is not told from 0",
    CAPPED: "more events in a forcing period than the cap allows",
    CAPPED_LATER: "more events in a forcing period than allowed while running on",
}


def reason_text(verdict: npt.NDArray[np.float64]) -> str:
    """Say in words why a run is called unsettled, or what was noted on the way; empty if nothing."""
    text = _TEXTS[int(verdict[REASON])].format(value=verdict[VALUE], other=verdict[OTHER])
    if not text and not math.isnan(verdict[NUDGED]):
        return "nudged: " + _TEXTS[ON_UNSTABLE].format(value=verdict[NUDGED])
    return text
