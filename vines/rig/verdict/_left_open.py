"""What the measured parameters leave open of the model's answer, and what the model leaves out of the rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.quantities import Reconstruction
from vines.rig.verdict._match import Candidate
from vines.rig.verdict._sensitivity import Numbers, sensitivity

__all__ = ["Open", "left_open"]

Floats = npt.NDArray[np.float64]

_RUBBED = 0.005 * 9.80665
_USUAL = Numbers(np.array([1.4e-3]), 1e-3, 1.5e-3)
"""What a friction of .005 g changes of the 1:1 orbit at A = .015 [rad, relative, relative]."""


@dataclass(frozen=True, slots=True, eq=False)
class Open:
    """Standard uncertainties of the model's answer.

    Attributes
    ----------
    by_parameters : Numbers or None
        By the uncertainties of the measured parameters, to first order; None where there is no stable orbit of the
        measured length to follow.
    by_forces : Numbers
        By the friction of the ball and the tilt of the cavity, which the model does not have.
    """

    by_parameters: Numbers | None
    by_forces: Numbers


def left_open(run: Reconstruction, candidate: Candidate, spread: dict[str, float], shown: Numbers) -> Open:
    """Return what is open about a branch, in the places of the pattern.

    Parameters
    ----------
    run : Reconstruction
        Gives friction, tilt and how much of the friction its effective restitution takes up.
    candidate : Candidate
    spread : dict
        Standard uncertainties of the parameters.
    shown : Numbers
        What the ensemble shows, phases in the places of the pattern, from the cut on.

    Notes
    -----
    Friction f at restitution r against no friction at r_effective: by_f f - by_r (r_effective - r). Near a pitchfork
    the smallest tilt turns symmetric orbits by degrees, which no constant allowance would tell.
    """
    q, orbit = run.quantities, candidate.orbit
    if orbit is None or not orbit.stable or len(orbit.t) != len(shown.phase):
        relative = _times(_USUAL, q["friction"].value / _RUBBED)
        phase = np.repeat(relative.phase, len(shown.phase))
        sizes = shown.max_abs_x1 * relative.max_abs_x1, shown.kinetic_ratio * relative.kinetic_ratio
        return Open(None, Numbers(phase, *sizes))
    by = sensitivity(orbit)
    turn = _place(orbit.phase - run.periods.cut, shown.phase)
    unit = q["b"].value * q["omega0"].value ** 2
    drop = q["r_effective"].value - q["r"].value
    rubbed = [_times(by["friction"], q["friction"].value / unit)]
    if "r" in by:
        rubbed.append(_times(by["r"], -drop))
    forces = _root([_sum(rubbed), _times(by["tilt"], float(np.hypot(q["tilt"].value, q["tilt"].u)) / unit)])
    known = _root([_times(by[name], u) for name, u in spread.items() if name in by])
    return Open(_rolled(known, turn), _rolled(forces, turn))


def _place(orbit: Floats, phases: Floats) -> int:
    """Return which impact of the orbit is the first place of the pattern."""

    def apart(turn: int) -> float:
        own = np.roll(orbit, -turn)
        gaps = np.diff(own, append=own[0]) - np.diff(phases, append=phases[0])
        return float(np.sum(np.abs(np.exp(1j * (own - phases)) - 1)) + np.sum(np.abs(np.exp(1j * gaps) - 1)))

    return min(range(len(orbit)), key=apart)


def _rolled(one: Numbers, turn: int) -> Numbers:
    return Numbers(np.roll(one.phase, -turn), one.max_abs_x1, one.kinetic_ratio)


def _times(one: Numbers, factor: float) -> Numbers:
    return Numbers(one.phase * factor, one.max_abs_x1 * factor, one.kinetic_ratio * factor)


def _sum(parts: list[Numbers]) -> Numbers:
    return Numbers(
        np.sum([one.phase for one in parts], axis=0),
        sum(one.max_abs_x1 for one in parts),
        sum(one.kinetic_ratio for one in parts),
    )


def _root(parts: list[Numbers]) -> Numbers:
    return Numbers(
        np.hypot.reduce([one.phase for one in parts]),
        float(np.hypot.reduce([one.max_abs_x1 for one in parts])),
        float(np.hypot.reduce([one.kinetic_ratio for one in parts])),
    )
