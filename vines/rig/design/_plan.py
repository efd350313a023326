"""Which dwells to make next, each with what it would tell and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.errors import OrbitNotFound, ParameterError
from vines.rig.design._branch_map import WORDS, Column, Stretch, branch_map
from vines.rig.design._information import Gain, gain, informed
from vines.rig.design._known import PARAMETERS, STATE, Known, known_of, measured_by, slopes_of
from vines.rig.quantities import Reconstruction
from vines.rig.verdict import measured_params, word_of

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["Plan", "Suggestion", "plan_runs"]

Floats = npt.NDArray[np.float64]

_SAFE = 3.0
"""Standard uncertainties to keep from the end of a branch, beyond which derivatives say what a dwell would show."""

_OPEN = 0.5
"""Largest uncertainty of the model's impact phase at which it is taken as linear [rad]."""

_BESIDE = 1.6
"""Distance in steps of the grid within which two suggestions are one."""

_HELPS = 0.9
"""What is left of an uncertainty where a dwell is said to be for it."""

_JUMPS = ("fold", "grazing", "period_doubling", "neimark_sacker")
"""Ends of a branch beyond which the rig goes elsewhere; an orbit that loses its symmetry only turns."""


@dataclass(frozen=True, slots=True, eq=False)
class Suggestion:
    """A dwell to make.

    Attributes
    ----------
    purpose : str
        ``inform``, ``coexist`` or ``jump``.
    A, Omega : float
        Where.
    f, E, E_cmd : float
        The same for the shaker: frequency [Hz], amplitude of the base [m], and the command that gives it, by how it
        sagged so far [m].
    volts : float
        Voltage at the shaker; nan where none was written down in the runs.
    branches : tuple of str
        What the model shows there.
    bits : float
        Expected information about `PARAMETERS`; 0 where derivatives do not hold.
    before, after : mapping of str to float
        Standard uncertainties of `PARAMETERS` without and with it.
    near : str
        The next end of a branch, with its distance in A and Omega in their uncertainties; empty if none is near.
    reason : str
        One line.
    """

    purpose: str
    A: float
    Omega: float
    f: float
    E: float
    E_cmd: float
    volts: float
    branches: tuple[str, ...]
    bits: float
    before: dict[str, float]
    after: dict[str, float]
    near: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Suggestions, the most telling first, and what they follow from.

    Attributes
    ----------
    known : Known
    columns : tuple of Column
        Stable branches over the plane.
    dwells : int
        How many dwells each suggestion is for.
    suggestions : tuple of Suggestion
    measured : ndarray, shape (runs, 2)
        A and Omega of the runs so far.
    """

    known: Known
    columns: tuple[Column, ...]
    dwells: int
    suggestions: tuple[Suggestion, ...]
    measured: Floats


def plan_runs(
    runs: Sequence[Reconstruction],
    *,
    count: int = 8,
    dwells: int = 5,
    length: float = 0.0,
    amplitudes: tuple[float, float] | None = None,
    omegas: tuple[float, float] | None = None,
    grid: tuple[int, int] = (15, 9),
) -> Plan:
    """Return what to measure next.

    Parameters
    ----------
    runs : sequence of Reconstruction
        So far.
    count : int
        Suggestions at most.
    dwells : int
        How many dwells at each place.
    length : float
        Of a dwell [s]; as the runs were if 0.
    amplitudes, omegas : (float, float), optional
        Ranges of A and Omega; a fifth beyond the runs and .4 % on either side if left out.
    grid : (int, int)
        Amplitudes and frequencies that are looked at.

    Raises
    ------
    RigError
        If there is no run.
    ParameterError
        If a range is none.

    Notes
    -----
    docs/rig.md, "What to measure next".
    """
    known = known_of(runs, length)
    at = np.array([[one.quantities["A"].value, one.quantities["Omega"].value] for one in runs])
    low, high = amplitudes or (0.85 * float(at[:, 0].min()), 1.2 * float(at[:, 0].max()))
    slow, fast = omegas or (float(at[:, 1].min()) - 0.004, float(at[:, 1].max()) + 0.004)
    for name, a, b in (("amplitudes", low, high), ("omegas", slow, fast)):
        if not 0 < a < b:
            raise ParameterError(f"{name} are {a:g} to {b:g}, allowed are 0 < from < to")
    grid_A, grid_Omega = np.linspace(low, high, grid[0]).tolist(), np.linspace(slow, fast, grid[1]).tolist()
    shown = [str(word_of(one.pattern.word)) for one in runs if one.accepted and one.pattern.holds]
    words = [word for word in dict.fromkeys((*WORDS, *shown)) if word]
    columns = branch_map(known.params, grid_A, grid_Omega, words)
    prior = _with_runs(known, runs)
    step = (grid_A[1] - grid_A[0], grid_Omega[1] - grid_Omega[0])
    found = [
        one
        for column in columns
        for A in grid_A
        if (one := _suggestion(known, prior, column, columns, A, dwells)) is not None
    ]
    found.sort(key=lambda one: -one.bits)
    chosen = _chosen(known, found, _warnings(known, columns, at), step, count, dwells)
    return Plan(known, columns, dwells, tuple(chosen), at)


def _with_runs(known: Known, runs: Sequence[Reconstruction]) -> Floats:
    """Return the covariance of the state with what the accepted runs tell by the model's derivatives."""
    from vines.orbits import all_orbits

    covariance = known.prior
    for run in runs:
        if not (run.accepted and run.pattern.holds):
            continue
        try:
            p = measured_params(run)
            stable = [one for one in all_orbits(word_of(run.pattern.word), p) if one.stable and one.admissible]
        except (OrbitNotFound, ParameterError):
            continue
        if stable and len(stable[0].t) <= 6:
            slopes = slopes_of(stable[0], known)
            if _linear(slopes, covariance):
                covariance = informed(covariance, slopes, measured_by(slopes, known))
    return covariance


def _linear(slopes: Floats, covariance: Floats) -> bool:
    phases = slopes[:-3]
    return bool(np.sqrt(np.einsum("ij,jk,ik->i", phases, covariance, phases)).max() < _OPEN)


def _suggestion(
    known: Known, prior: Floats, column: Column, columns: Sequence[Column], A: float, dwells: int
) -> Suggestion | None:
    """Return what dwells at a place would tell; None where no stable branch is, or its end is too near."""
    here = [(stretch, orbit) for stretch in column.stretches if (orbit := _at(stretch, A)) is not None]
    measurements, names = [], []
    near = ""
    for stretch, orbit in here:
        far, told = _ending(known, column, columns, stretch, A)
        if far < _SAFE:
            near = told
            continue
        slopes = slopes_of(orbit, known)
        if not _linear(slopes, prior):
            continue
        near = near or (told if far < 4 * _SAFE else "")
        measurements.append((slopes, measured_by(slopes, known)))
        names.append(_called(stretch))
    if not measurements:
        return None
    found = gain(prior, measurements, np.arange(len(PARAMETERS)), dwells)
    before, after = _deviations(known, found)
    kind = "coexist" if len(set(names)) > 1 else "inform"
    made = _made(known, kind, A, column.Omega, tuple(names), found.bits, before, after, near, "")
    return replace(made, reason=_said(known, made, dwells))


def _at(stretch: Stretch, A: float) -> Orbit | None:
    return next((one for one in stretch.orbits if abs(one.params.A - A) < 1e-6 * A), None)


def _called(stretch: Stretch) -> str:
    asymmetric = stretch.name == "1:1" and not stretch.symmetric
    return f"{stretch.name} asymmetric" if asymmetric else stretch.name


def _deviations(known: Known, found: Gain) -> tuple[dict[str, float], dict[str, float]]:
    return tuple(
        {name: float(values[STATE.index(name)]) * known.unit(name) for name in PARAMETERS}
        for values in (found.before, found.after)
    )  # type: ignore[return-value]


def _said(known: Known, one: Suggestion, dwells: int, focus: str = "") -> str:
    """Return in words what dwells would change, of the parameter in focus first."""
    order = sorted(PARAMETERS, key=lambda name: (name != focus, one.after[name] / one.before[name]))
    told = []
    for name in order[:2]:
        before, after, unit = one.before[name], one.after[name], PARAMETERS[name][0]
        if after < 0.97 * before or name == focus:
            told.append(f"u({name}) from {before:.2g} to {after:.2g}" + (f" {unit}" if unit != "1" else ""))
    names = tuple(dict.fromkeys(one.branches))
    count = f"{dwells} more dwells of {known.length:.0f} s here" + (" on each branch" if len(names) > 1 else "")
    head = f"{' and '.join(names)} coexist, reached from above and from below; " if len(names) > 1 else ""
    if not told:
        return f"{head}{count} tell little more than the runs so far"
    return f"{head}{count} bring {' and '.join(told)}"


def _ending(known: Known, column: Column, columns: Sequence[Column], stretch: Stretch, A: float) -> tuple[float, str]:
    """Return how near the next end of a stretch is, in uncertainties of A or Omega, and what it is."""
    u_A = A * float(np.sqrt(known.prior[STATE.index("A"), STATE.index("A")]))
    u_Omega = column.Omega * float(np.sqrt(known.prior[STATE.index("omega0"), STATE.index("omega0")]))
    best, told = np.inf, ""
    for way, (edge, kind) in enumerate(zip((stretch.low, stretch.high), stretch.ends, strict=True)):
        if kind == "range":
            continue
        slope = _slope(column, columns, stretch, way)
        in_A, by_Omega = abs(A - edge), abs(A - edge) / abs(slope) if slope else np.inf
        far = in_A / float(np.hypot(u_A, slope * u_Omega))
        if far < best:
            also = f", {by_Omega / u_Omega:.1f} u in Omega" if np.isfinite(by_Omega) else ""
            best = far
            told = f"{kind.replace('_', ' ')} of {_called(stretch)} at A = {edge:.5f} ({in_A / u_A:.1f} u in A{also})"
    return best, told


def _slope(column: Column, columns: Sequence[Column], stretch: Stretch, way: int) -> float:
    """Return how the end of a stretch moves with Omega, from the columns beside it; 0 where it has no like."""
    edge, kind = (stretch.low, stretch.high)[way], stretch.ends[way]
    slopes = []
    for other in sorted(columns, key=lambda one: abs(one.Omega - column.Omega))[1:3]:
        alike = [
            (one.low, one.high)[way]
            for one in other.stretches
            if (one.word, one.symmetric, one.ends[way]) == (stretch.word, stretch.symmetric, kind)
        ]
        if alike:
            nearest = min(alike, key=lambda value: abs(value - edge))
            slopes.append((nearest - edge) / (other.Omega - column.Omega))
    return float(np.mean(slopes)) if slopes else 0.0


def _warnings(known: Known, columns: Sequence[Column], at: Floats) -> list[Suggestion]:
    """Return the jumps next to where was measured: a dwell on either side shows where they are."""
    middle = float(np.median(at[:, 1]))
    column = min(columns, key=lambda one: abs(one.Omega - middle))
    u_A = float(np.sqrt(known.prior[STATE.index("A"), STATE.index("A")]))
    found: list[Suggestion] = []
    edges: list[float] = []
    for stretch in column.stretches:
        for way, (edge, kind) in enumerate(zip((stretch.low, stretch.high), stretch.ends, strict=True)):
            if kind not in _JUMPS or any(abs(edge / other - 1) < u_A for other in edges):
                continue
            # From the stable side, as near as the amplitude is known.
            place = edge * (1 + (1 if way == 0 else -1) * _SAFE * u_A)
            if not stretch.low <= place <= stretch.high:
                continue
            nearest = float(np.min(np.abs(at[:, 0] - edge))) / (edge * u_A)
            _, told = _ending(known, column, columns, stretch, place)
            what = kind.replace("_", " ")
            reason = (
                f"{what} of {_called(stretch)}: beyond A = {edge:.5f} the rig leaves it; the nearest run is "
                f"{nearest:.0f} u(A) away; go from here {'down' if way == 0 else 'up'} in steps of u(A), E by "
                f"{1e3 * edge * u_A * known.values['b']:.2g} mm"
            )
            found.append(_made(known, "jump", place, column.Omega, (_called(stretch),), 0.0, {}, {}, told, reason))
    found.sort(key=lambda one: float(np.min(np.abs(at[:, 0] - one.A))))
    return found


def _made(
    known: Known, kind: str, A: float, Omega: float, branches: tuple[str, ...], bits: float,
    before: dict[str, float], after: dict[str, float], near: str, reason: str,
) -> Suggestion:  # fmt: skip
    values = known.values
    E = A * values["b"]
    f = Omega * values["omega0"] / (2 * np.pi)
    return Suggestion(
        kind, A, Omega, f, E, E / values["sag"], E / values["volts"], branches, bits, before, after, near, reason
    )


def _chosen(
    known: Known, found: Sequence[Suggestion], jumps: Sequence[Suggestion], step: tuple[float, float], count: int,
    dwells: int,
) -> list[Suggestion]:  # fmt: skip
    """Return at most so many, none beside another, and the nearest jumps, a third of them at most.

    First come the best for each parameter and the best where branches coexist, then the most telling of the rest.
    """
    room = count - min(len(jumps), count // 3)
    best: list[Suggestion] = list(found[:1])
    for name in PARAMETERS:
        one = min(found, key=lambda one: one.after[name] / one.before[name], default=None)
        if one is not None and one.after[name] < _HELPS * one.before[name]:
            best.append(replace(one, reason=_said(known, one, dwells, name)))
    best += [one for one in found if one.purpose == "coexist"][:1]
    kept: list[Suggestion] = []
    for one in (*best, *found):
        beside = any(
            abs(one.A - other.A) < _BESIDE * step[0] and abs(one.Omega - other.Omega) < _BESIDE * step[1]
            for other in kept
        )
        if len(kept) < room and not beside:
            kept.append(one)
    return [*sorted(kept, key=lambda one: -one.bits), *jumps[: count - room]]
