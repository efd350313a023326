"""What the ball's own sensor says beside the reconstruction: the same impacts, the same walls, the same restitution?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.camera._sight import Sight
from vines.rig.recording import Uncertain
from vines.rig.uncertainty import combined

__all__ = ["Witness", "witness"]

Floats = npt.NDArray[np.float64]

_TOGETHER = 4e-3
"""Impacts nearer than this are one [s]: the clocks are aligned better, and a cavity is crossed in longer."""

_SHARP = 8.0
"""Standard uncertainties that a turn of the ball must have to be missed by its sensor."""


@dataclass(frozen=True, slots=True, eq=False)
class Witness:
    """The ball's own sensor beside the motion that was inferred from the oscillator.

    Attributes
    ----------
    shared : int
        Impacts that both show.
    camera_only, oscillator_only : int
        Those of one that the other had to show, neither too soft for it nor in a gap, and does not.
    away : float
        Root mean square of the differences of their times [s]; nan without any.
    scale : Uncertain
        What a length is by the sensor over what it is by the gauge of the cavity.
    b : Uncertain
        Half length of the cavity by the sensor as it is calibrated [m].
    r, beside : Uncertain or None
        Restitution by the velocities that the sensor shows, and that which was inferred of the same impacts; the
        uncertainty of `beside` is that of their difference by noise. None where fewer than six impacts tell both.
    """

    shared: int
    camera_only: int
    oscillator_only: int
    away: float
    scale: Uncertain
    b: Uncertain
    r: Uncertain | None
    beside: Uncertain | None


def witness(sight: Sight, impacts: npt.NDArray[np.void], b: Uncertain) -> Witness | None:
    """Lay impacts that a sensor saw beside those that were inferred; None if they share fewer than four.

    Parameters
    ----------
    sight : Sight
        On the clock of the run.
    impacts : structured ndarray
        Reconstructed, dtype `IMPACT`; those that were taken over from the sensor (``by_camera``) count as its alone.
    b : Uncertain
        Half length of the cavity by gauge [m].
    """
    seen, own = sight.flights, impacts
    here, there, late = _pairs(seen.t, seen.side, np.asarray(own["t"]), np.asarray(own["side"]))
    if len(here) < 4:
        return None
    lent = np.asarray(own["by_camera"])
    both = ~lent[there]
    away = (seen.t[here] - late - own["t"][there])[both]
    only_seen = np.ones(len(seen), bool)
    only_seen[here[both]] = False
    only_seen &= (seen.t > impacts["t"][0] - _TOGETHER) & (seen.t < impacts["t"][-1] + _TOGETHER)
    sharp = np.abs(seen.v_after - seen.v_before) > _SHARP * np.hypot(seen.u_before, seen.u_after)
    only_seen &= sharp
    only_own = ~lent
    only_own[there] = False
    only_own &= ~_hidden(np.asarray(own["t"]), np.asarray(own["v2_after"] - own["v2"]), sight)
    left, right = own["side"][there] > 0, own["side"][there] < 0
    if not left.any() or not right.any():
        return None
    x1, x2 = np.asarray(own["x1"])[there], seen.x[here]
    of_x1, of_x2 = (0.5 * float(x[left].mean() - x[right].mean()) for x in (x1, x2))
    u_x2 = 0.5 * float(np.hypot(*(x2[which].std() / np.sqrt(which.sum()) for which in (left, right))))
    u_gain = sight.channel.u_gain
    found = combined(of_x1 - of_x2, abs(of_x2) * u_gain, u_x2)
    scale = combined(of_x2 / (of_x1 - b.value), b.u / abs(of_x1 - b.value), u_x2 / abs(of_x2))
    r, beside = _restitution(sight, own, here, there)
    return Witness(
        int(both.sum()), int(only_seen.sum()), int(only_own.sum()),
        float(np.sqrt(np.mean(away**2))) if len(away) else float("nan"), scale, found, r, beside,
    )  # fmt: skip


def _pairs(
    t: Floats, side: Floats, own: Floats, own_side: Floats
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], float]:
    """Return which impacts are one, each once, and by how much those of the sensor are late."""
    late = 0.0
    nearest, near = np.zeros(len(t), np.intp), np.zeros(len(t), bool)
    for _ in range(2):
        place = np.clip(np.searchsorted(own, t - late), 1, max(len(own) - 1, 1))
        nearest = np.where(np.abs(own[place - 1] - t + late) < np.abs(own[place] - t + late), place - 1, place)
        near = (np.abs(own[nearest] - t + late) < _TOGETHER) & (own_side[nearest] == side)
        if not near.any():
            break
        late += float(np.median((t - late - own[nearest])[near]))
    here = np.flatnonzero(near)
    first = np.unique(nearest[here], return_index=True)[1]
    return here[first], nearest[here[first]], late


def _hidden(t: Floats, turn: Floats, sight: Sight) -> npt.NDArray[np.bool_]:
    """Say which impacts the sensor need not show: in its gaps, too soft, or nearer to the next than three positions."""
    seen = sight.flights
    least = _SHARP * float(np.median(np.hypot(seen.u_before, seen.u_after)))
    short = 3 / min(sight.channel.rate, 1000.0)
    near = np.zeros(len(t), bool)
    near[1:] |= np.diff(t) < short
    near[:-1] |= np.diff(t) < short
    gap = (t[:, None] > seen.gaps[:, 0] - short) & (t[:, None] < seen.gaps[:, 1] + short)
    return near | gap.any(axis=1) | ~(np.abs(turn) > least)


def _restitution(
    sight: Sight, own: npt.NDArray[np.void], here: npt.NDArray[np.intp], there: npt.NDArray[np.intp]
) -> tuple[Uncertain | None, Uncertain | None]:
    """Return r by the sensor's velocities, and the inferred one of the same impacts."""
    seen = sight.flights
    tell = seen.clear[here] & np.isfinite(own["r"][there]) & ~own["suspect"][there]
    here, there = here[tell], there[tell]
    if len(here) < 6:
        return None, None
    side = np.asarray(own["side"])[there]

    def speeds(scale: float) -> tuple[Floats, Floats]:
        before = (own["v1"][there] - seen.v_before[here] / scale) * side
        after = (own["v1_after"][there] - seen.v_after[here] / scale) * side
        return np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64)

    def ratio(before: Floats, after: Floats) -> float:
        return -float(after.sum() / before.sum())

    before, after = speeds(1.0)
    r = ratio(before, after)
    theirs = np.asarray(own["w_dot"])[there] * side, np.asarray(own["w_dot_after"])[there] * side
    count, size = np.sqrt(len(here)), float(np.abs(before).mean())
    noise = after + r * before
    apart = noise - (theirs[1] + r * theirs[0])
    by_gain = ratio(*speeds(1 + sight.channel.u_gain)) - r
    u_noise = float(apart.std()) / count / size
    return (
        combined(r, float(noise.std()) / count / size, by_gain),
        combined(ratio(*theirs), u_noise, by_gain),
    )
