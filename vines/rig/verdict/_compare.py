"""Runs beside the model, at measured parameters and at calibrated ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from vines.errors import ParameterError, VinesError
from vines.model import Params
from vines.rig.quantities import Reconstruction
from vines.rig.verdict._match import candidates, word_of
from vines.rig.verdict._model import measured_params, parameter_spread, predict
from vines.rig.verdict._sensitivity import sensitivity
from vines.rig.verdict._verdict import Comparison, decide, likeness, order

__all__ = ["Calibration", "calibrate", "compare", "compare_all"]

_FREE = {"Omega": 1e-3, "A": 0.03, "r": 0.01}
"""What a calibration may move, with the relative (r: absolute) standard deviation that it may move by."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """Corrections found on one half of the runs.

    Attributes
    ----------
    Omega, A : float
        Factors.
    r : float
        Added.
    u : mapping of str to float
        Standard uncertainties of the corrections.
    runs : tuple of str
        The runs they come from.
    """

    Omega: float = 1.0
    A: float = 1.0
    r: float = 0.0
    u: Mapping[str, float] = field(default_factory=lambda: dict(_FREE))
    runs: tuple[str, ...] = ()

    def on(self, p: Params) -> Params:
        """Return corrected parameters."""
        return p.replace(Omega=p.Omega * self.Omega, A=p.A * self.A, r=min(max(p.r + self.r, 0.0), 1.0))

    def spread(self, measured: Mapping[str, float], p: Params) -> dict[str, float]:
        """Return standard uncertainties of corrected parameters: an error that all runs share is taken out of them."""
        own = {"Omega": p.Omega * self.u["Omega"], "A": p.A * self.u["A"], "r": self.u["r"]}
        return {name: min(u, own.get(name, u)) for name, u in measured.items()}


def compare(
    run: Reconstruction,
    catalogue: Sequence[Mapping[str, Any]] = (),
    *,
    calibration: Calibration | None = None,
    seed: int = 0,
) -> Comparison:
    """Compare a run with every branch that coexists at its parameters.

    Parameters
    ----------
    run : Reconstruction
    catalogue : sequence of mapping
        Rows of the table ``orbits``: words that may exist near.
    calibration : Calibration, optional
        Corrections of the measured parameters; the comparison then says ``calibrated``.
    seed : int
        Of the ensembles.
    """
    basis = "measured" if calibration is None else "calibrated"
    try:
        p = measured_params(run)
        p = calibration.on(p) if calibration is not None else p
    except ParameterError as error:
        empty = Params(mu=1.0, A=0.0)
        return Comparison(run, empty, basis, (), "undecidable", f"the measured parameters are impossible: {error}")
    if not run.accepted or not run.pattern.holds:
        verdict, reason = decide(run, ())
        return Comparison(run, p, basis, (), verdict, reason)
    spread = parameter_spread(run)
    if calibration is not None:
        spread = calibration.spread(spread, p)
    found = candidates(p, word_of(run.pattern.word), catalogue, spread)
    branches = order([likeness(run, predict(run, p, one, spread, seed=seed)) for one in found])
    verdict, reason = decide(run, branches)
    return Comparison(run, p, basis, branches, verdict, reason)


def calibrate(measured: Sequence[Comparison]) -> Calibration:
    """Find common corrections of Omega, A and r that bring runs nearest to their branches.

    Parameters
    ----------
    measured : sequence of Comparison
        At measured parameters; only those count whose pattern the model shows.

    Returns
    -------
    Calibration
        One Gauss–Newton step with the deterministic orbit's derivatives, held near 1 by what may be wrong with a rig's
        omega0, E and r.
    """
    rows, left, names = [], [], []
    for one in measured:
        if one.verdict not in ("agree", "pattern_only"):
            continue
        best, orbit = one.branches[0], one.branches[0].predicted.candidate.orbit
        by = sensitivity(orbit) if orbit is not None and orbit.stable else {}
        if orbit is None or not by.keys() >= _FREE.keys():
            continue
        # Omega and A are corrected by factors.
        unit = {"Omega": orbit.params.Omega, "A": orbit.params.A, "r": 1.0}
        turns = np.exp(1j * (orbit.phase - one.run.periods.cut)) - np.exp(1j * best.model["phase"].value)
        place = int(np.argmin(np.abs(turns)))
        for name in ("phase", "max_abs_x1", "kinetic_ratio"):
            scale = float(np.hypot(best.measured[name].u, best.model[name].u)) or 1.0
            gap = best.measured[name].value - best.model[name].value
            if name == "phase":
                gap = float((gap + np.pi) % (2 * np.pi) - np.pi)
            slopes = [by[key].phase[place] if name == "phase" else getattr(by[key], name) for key in _FREE]
            rows.append([slope * unit[key] / scale for slope, key in zip(slopes, _FREE, strict=True)])
            left.append(gap / scale)
        names.append(one.run.run.run_id)
    if not rows:
        return Calibration()
    free = np.array([_FREE["Omega"], _FREE["A"], _FREE["r"]])
    matrix = np.vstack([np.array(rows), np.diag(1 / free)])
    step = np.linalg.lstsq(matrix, np.concatenate([left, np.zeros(3)]), rcond=None)[0]
    u = np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix)))
    return Calibration(
        1 + float(step[0]), 1 + float(step[1]), float(step[2]), dict(zip(_FREE, u.tolist(), strict=True)), tuple(names)
    )


def compare_all(
    runs: Sequence[Reconstruction],
    catalogue: Sequence[Mapping[str, Any]] = (),
    *,
    seed: int = 0,
    spread: Callable[..., Iterable[Comparison]] = map,
) -> tuple[tuple[Comparison, ...], tuple[Comparison, ...], Calibration]:
    """Compare runs at measured parameters, calibrate on every other one, and compare the rest again.

    Parameters
    ----------
    runs : sequence of Reconstruction
        In the order of time.
    catalogue : sequence of mapping
        As for `compare`.
    seed : int
        Of the ensembles.
    spread : callable
        ``spread(function, runs)`` applies a function to each run, such as :func:`map`, or in several processes.

    Returns
    -------
    measured, calibrated : tuple of Comparison
        All runs; those that the calibration did not use.
    calibration : Calibration
        Without runs in it where fewer than four are at hand.
    """
    measured = tuple(spread(partial(_compare_one, catalogue=catalogue, seed=seed), runs))
    if len(runs) < 4:
        return measured, (), Calibration()
    found = calibrate(measured[::2])
    if not found.runs:
        return measured, (), found
    again = partial(_compare_one, catalogue=catalogue, calibration=found, seed=seed)
    return measured, tuple(spread(again, runs[1::2])), found


def _compare_one(
    run: Reconstruction, catalogue: Sequence[Mapping[str, Any]], seed: int, calibration: Calibration | None = None
) -> Comparison:
    """Compare a run among others; where that cannot be done it is undecidable, and the others go on."""
    try:
        return compare(run, catalogue, calibration=calibration, seed=seed)
    except (VinesError, ArithmeticError, ValueError) as error:
        basis, why = "measured" if calibration is None else "calibrated", " ".join(str(error).split())
        return Comparison(run, measured_params(run), basis, (), "undecidable", f"it could not be compared: {why}")
