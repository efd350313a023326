"""What the runs so far tell of a rig: its parameters, what is uncertain of them, and how well a dwell measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.model import PARAMETER_NAMES, Params
from vines.rig.quantities import Reconstruction
from vines.rig.verdict import Numbers, sensitivity

if TYPE_CHECKING:
    from vines.orbits import Orbit

__all__ = ["PARAMETERS", "STATE", "Known", "known_of", "measured_by", "slopes_of"]

Floats = npt.NDArray[np.float64]

PARAMETERS = {
    "mu": ("1", "mass ratio"),
    "r": ("1", "restitution"),
    "friction": ("m/s^2", "deceleration of the ball by friction"),
    "tilt": ("m/s^2", "acceleration of the ball along the cavity"),
    "omega0": ("rad/s", "natural frequency: the stiffness"),
}
"""What a verdict is about, with units."""

STATE = (*PARAMETERS, "A", "lam", "phase", "size", "r_offset")
"""Those and what all dwells share beside them: relative errors of A and of sizes of x1, damping, errors of phases [rad]
and of the restitution as it is measured."""

_WANDERS = 1.5e-5
"""Relative change of omega0 from dwell to dwell that the reading of the temperature, to .1 K, leaves open."""

_LEAST = {"phase": 1e-3, "size": 2e-4, "ratio": 5e-4, "r": 1e-4}
"""Least noise of a dwell: of the phase [rad], of max|x1| and of K2/K1, relative, and of r."""


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """What is known of a rig before the next dwell.

    Attributes
    ----------
    params : Params
        In the middle of the runs.
    values : mapping of str to float
        Of `PARAMETERS`, in their units; and ``b`` [m], ``sag`` (E over E_cmd), ``volts`` (E over the shaker's voltage
        [m/V], nan where nobody wrote that down).
    prior : ndarray, shape (n, n)
        Covariance of `STATE`; of mu, omega0, A and sizes that of their logarithm.
    noise : mapping of str to float
        Of a dwell of `length` seconds: ``phase`` [rad], ``size`` and ``ratio`` (relative, of max|x1| and K2/K1), ``r``.
    rubbed : float
        How much the measured restitution, friction left in, changes by friction [1/(m/s^2)].
    length : float
        Of a dwell [s].
    runs : tuple of str
        The runs that this comes from.
    """

    params: Params
    values: dict[str, float]
    prior: Floats
    noise: dict[str, float]
    rubbed: float
    length: float
    runs: tuple[str, ...]

    def unit(self, name: str) -> float:
        """Return by what a standard uncertainty of the state is multiplied to be in the unit of the parameter."""
        return self.values[name] if name in ("mu", "omega0") else 1.0


def known_of(runs: Sequence[Reconstruction], length: float = 0.0) -> Known:
    """Return what runs tell.

    Parameters
    ----------
    runs : sequence of Reconstruction
        Those that were accepted count, all if none was.
    length : float
        Of a dwell to come [s]; as long as the runs are if 0.

    Raises
    ------
    RigError
        If there is no run.
    """
    fair = [one for one in runs if one.accepted] or list(runs)
    if not fair:
        raise RigError("no run is at hand: what to measure next follows from what was measured")
    q = [one.quantities for one in fair]

    def middle(values: Sequence[float]) -> float:
        fit = [value for value in values if np.isfinite(value)]
        return float(np.median(fit)) if fit else float("nan")

    at = {name: middle([one["r_effective" if name == "r" else name].value for one in q]) for name in PARAMETER_NAMES}
    at["r"] = min(max(at["r"], 0.05), 1.0)
    spans = [len(one.periods.words) / one.quantities["f"].value for one in fair]
    span = middle(spans)
    length = length or span
    shorter = float(np.sqrt(span / length))
    u = {
        "mu": middle([one["mu"].u / one["mu"].value for one in q]),
        "r": 0.05,
        "friction": middle([one["friction"].u for one in q]),
        "tilt": middle([one["tilt"].u for one in q]),
        "omega0": middle([one["omega0"].u / one["omega0"].value for one in q]),
        "A": middle([one["A"].u / one["A"].value for one in q]),
        "lam": middle([one["lam"].u for one in q]),
        "phase": middle([run.budget.get("impact_phase", {}).get("delay", np.nan) for run in fair]),
        "size": middle([_part(run, "max_abs_x1", "correction") for run in fair]),
        "r_offset": middle([_calibrated(run) for run in fair]),
    }
    prior = np.diag([max(u[name] if np.isfinite(u[name]) else 0.0, 1e-9) ** 2 for name in STATE])
    noise = {
        "phase": middle([run.budget.get("impact_phase", {}).get("scatter", np.nan) for run in fair]),
        "size": middle([_part(run, "max_abs_x1", "scatter") for run in fair]),
        "ratio": middle([_part(run, "kinetic_ratio", "scatter") for run in fair]),
        "r": middle([run.budget.get("r_effective", {}).get("scatter", np.nan) for run in fair]),
    }
    noise = {key: max(value if np.isfinite(value) else 0.0, _LEAST[key]) * shorter for key, value in noise.items()}
    values = {name: middle([one[name].value for one in q]) for name in (*PARAMETERS, "b", "lam")}
    commanded = [(run.quantities["E"].value, run.run.E_cmd) for run in fair if run.run.E_cmd]
    values["sag"] = middle([E / told for E, told in commanded]) if commanded else 1.0
    driven = [(run.quantities["E"].value, run.run.more.get("voltage")) for run in fair]
    values["volts"] = middle([E / float(v) for E, v in driven if isinstance(v, int | float) and v > 0])
    rubbed = middle([_rubbed(run) for run in fair])
    return Known(
        Params(**at), values, prior, noise, rubbed if np.isfinite(rubbed) else 0.0, length,
        tuple(run.run.run_id for run in fair),
    )  # fmt: skip


def _part(run: Reconstruction, quantity: str, source: str) -> float:
    """Return what a source adds to a quantity, relative."""
    return run.budget.get(quantity, {}).get(source, float("nan")) / run.quantities[quantity].value


def _calibrated(run: Reconstruction) -> float:
    """Return what all runs share of the error of the restitution, friction apart."""
    parts = run.budget.get("r_effective", {})
    return float(np.hypot.reduce([u for source, u in parts.items() if source not in ("scatter", "friction")]))


def _rubbed(run: Reconstruction) -> float:
    friction = run.quantities["friction"]
    by = run.budget.get("r", {}).get("friction", float("nan"))
    return by / friction.u if friction.u > 1e-5 else float("nan")


def slopes_of(orbit: Orbit, known: Known) -> Floats:
    """Return the derivatives of what a dwell on an orbit measures by `STATE`, shape (N + 3, n).

    Rows are the N impact phases [rad], the logarithms of max|x1| and of K2/K1 over mu, and the restitution between
    mean velocities of flights.
    """
    by = sensitivity(orbit)
    p, size = orbit.params, orbit.measures
    count = len(orbit.t)
    unit = known.values["b"] * known.values["omega0"] ** 2
    rows = np.zeros((count + 3, len(STATE)))

    def set_(name: str, one: Numbers, factor: float) -> None:
        column = STATE.index(name)
        rows[:count, column] += factor * one.phase
        rows[count, column] += factor * one.max_abs_x1 / size.max_abs_x1
        rows[count + 1, column] += factor * one.kinetic_ratio / size.kinetic_ratio

    for name, parameter, factor in (
        ("mu", "mu", p.mu), ("r", "r", 1.0), ("A", "A", p.A), ("lam", "lam", 1.0), ("omega0", "Omega", -p.Omega),
        ("friction", "friction", 1 / unit), ("tilt", "tilt", 1 / unit),
    ):  # fmt: skip
        if parameter in by:
            set_(name, by[parameter], factor)
    # K2/K1 is measured with the weighed mu, so that what the masses are off falls out.
    rows[count + 1, STATE.index("mu")] -= 1.0
    rows[:count, STATE.index("phase")] = 1.0
    rows[count, STATE.index("size")] = 1.0
    rows[count + 2, STATE.index("r")] = 1.0
    rows[count + 2, STATE.index("friction")] = -known.rubbed
    rows[count + 2, STATE.index("r_offset")] = 1.0
    return rows


def measured_by(slopes: Floats, known: Known) -> Floats:
    """Return the covariance of the errors of a dwell, for the rows of `slopes_of`: scatter, and a rig that warms up."""
    count = len(slopes) - 3
    noise = np.diag([known.noise["phase"] ** 2] * count + [known.noise[key] ** 2 for key in ("size", "ratio", "r")])
    wander = slopes[:, STATE.index("omega0")] * _WANDERS
    return noise + np.outer(wander, wander)
