"""From settings to the true motion: the kernel's parameters, the settling, the record, and what was hit when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from vines.rig.synth._contact import damping_table, stiffness
from vines.rig.synth._kernel import IMPACT, NAMES, NUMBER, PHASE, ROW, advance
from vines.rig.synth._settings import RigSettings

__all__ = ["LEAD", "Motion", "kernel_parameters", "move", "parameter_array"]

LEAD = 3.0
"""[s] Motion before the first sample, in which couplings settle and delays and offsets lie."""
_G = 9.80665
_REFERENCE_TEMPERATURE = 20.0
_MANY = 200_000
_STEPS_A_CONTACT = 160
_COARSE = 4
"""While the rig settles, steps in flight are so many times longer: nothing is recorded then."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """The true motion of a run, at the steps of a clock without error.

    Attributes
    ----------
    step : float
        Seconds between rows.
    start : float
        Time of the first row since the base began to move [s].
    x1, v1, x2, v2 : ndarray of float64, shape (n,)
        Positions [m] and velocities [m/s], positive to the right.
    acc : ndarray of float64, shape (n,)
        Acceleration of the oscillator where its accelerometer sits, ringing included, mean over the step before.
    impacts : structured ndarray
        Columns of :data:`vines.rig.synth._kernel.IMPACT`; times since `start`.
    end : ndarray of float64, shape (9,)
        State of the kernel at the end and phase of the base there, from which another run can go on.
    parameters : mapping of str to float
        What the kernel was given.
    swell : ndarray, shape (2, n)
        Times since the base began to move [s] and what E is multiplied with then.
    quiet : ndarray of bool
        Impacts that the accelerometer missed.
    """

    step: float
    start: float
    x1: npt.NDArray[np.float64]
    v1: npt.NDArray[np.float64]
    x2: npt.NDArray[np.float64]
    v2: npt.NDArray[np.float64]
    acc: npt.NDArray[np.float64]
    impacts: np.ndarray
    end: npt.NDArray[np.float64]
    parameters: dict[str, float]
    quiet: npt.NDArray[np.bool_]
    swell: npt.NDArray[np.float64]

    def swollen(self, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | float:
        """Return what E is multiplied with at times since `start`."""
        return np.interp(times + self.start, *self.swell) if self.swell.size else 1.0

    def base(self, times: npt.NDArray[np.float64], derivative: int = 0) -> npt.NDArray[np.float64]:
        """Return displacement (or its n-th derivative) of the base at times since `start`."""
        p = self.parameters
        total = np.zeros_like(times)
        for n, part, shift in ((1, 1.0, 0.0), (2, p["h2"], p["phi2"]), (3, p["h3"], p["phi3"])):
            if part:
                omega = n * p["omega"]
                angle = omega * (times + self.start) + n * p["phi"] + shift + derivative * np.pi / 2
                total += p["E"] * part * omega**derivative * np.sin(angle)
        # The slope of the amplitude is left out of velocities and accelerations: it is slow beside the sine.
        return total * self.swollen(times)


def kernel_parameters(s: RigSettings, rng: np.random.Generator) -> dict[str, float]:
    """Return the parameters of the kernel by name."""
    reduced = s.M * s.m / (s.M + s.m)
    pull = _G * float(np.sin(np.radians(s.tilt)))
    moving = s.protocol != "ringdown"
    phi, phi2, phi3 = rng.uniform(0, 2 * np.pi, 3)
    return {
        "M": s.M, "m": s.m, "c": s.c, "k": s.k,
        "E": s.E * (1 - s.sag) if moving else 0.0,
        "omega": 2 * np.pi * s.f, "phi": phi, "h2": s.h2, "phi2": phi2, "h3": s.h3, "phi3": phi3,
        "left": s.b + s.asymmetry / 2, "right": s.b - s.asymmetry / 2,
        "K": stiffness(s.contact_time, s.r_speed, s.r, reduced),
        "friction": s.friction * _G if s.ball else 0.0, "pull": pull,
        "softening": 2 * s.softening,
        "T0": s.temperature[0] - _REFERENCE_TEMPERATURE, "T1": s.temperature[1] - _REFERENCE_TEMPERATURE,
        "span": s.settle + s.duration,
        "r": s.r, "exponent": s.r_exponent, "reference": s.r_speed,
        "pause": s.contact_time / _STEPS_A_CONTACT,
    }  # fmt: skip


def parameter_array(p: dict[str, float]) -> npt.NDArray[np.float64]:
    """Return parameters in the order of the kernel."""
    return np.array([p[name] for name in NAMES])


def move(s: RigSettings, rng: np.random.Generator, step: float, extra: int, state: np.ndarray | None = None) -> Motion:
    """Let the rig settle and record it.

    Parameters
    ----------
    s : RigSettings
        The rig.
    rng : Generator
        For scatter of r, phases and missed impacts.
    step : float
        Seconds between rows.
    extra : int
        Rows beyond those of the record, so that clocks and delays stay inside.
    state : ndarray, shape (9,), optional
        End of the run before; `s.start` if left out.
    """
    p = kernel_parameters(s, rng)
    if state is not None:
        # The generator runs on from the run before.
        p["phi"] = float(state[PHASE])
    values = parameter_array(p)
    modes = np.array([complex(-z, np.sqrt(1 - z * z)) * 2 * np.pi * f for f, z, _ in s.modes], np.complex128)
    gains = np.zeros((2, len(modes)), np.complex128)
    gains[0] = [gain for *_, gain in s.modes]
    draws = rng.normal(0.0, s.sigma_r, _MANY) if s.sigma_r else np.zeros(1)
    quiet = rng.random(_MANY) < s.missed
    state = np.array([*s.start, 0.0, 0.0, -1.0, 0.0, 0.0]) if state is None else state.copy()
    state[ROW] = -1.0
    state[NUMBER] = 0.0
    tables = damping_table()
    before = round(s.settle / step / _COARSE)
    courses = [_course(knots, _COARSE * before * step) for knots in (s.E_course, s.r_course)]
    swell, worn = courses
    count = round(s.duration / step) + extra
    nothing = np.empty((5, 0))
    none = np.empty((0, len(IMPACT)))
    advance(
        state, 0, before, _COARSE * step, values, draws, quiet, *tables, modes, gains, swell, worn, s.ball, nothing,
        none,
    )  # fmt: skip
    out = np.empty((5, count + 1))
    rows = np.full((min(_MANY, 2000 * int(s.duration + 10)), len(IMPACT)), np.nan)
    first = int(state[NUMBER])
    found = advance(
        state, _COARSE * before, count, step, values, draws, quiet, *tables, modes, gains, swell, worn, s.ball, out,
        rows,
    )  # fmt: skip
    state[PHASE] = (p["omega"] * (_COARSE * before + count) * step + p["phi"]) % (2 * np.pi)
    impacts = np.rec.fromarrays(rows[:found].T.copy(), dtype=np.dtype([(name, np.float64) for name in IMPACT]))
    start = _COARSE * before * step
    impacts["t"] -= start
    impacts["t_end"] -= start
    impacts["t_mid"] -= start
    return Motion(
        step=step, start=start, x1=out[0], v1=out[1], x2=out[2], v2=out[3], acc=out[4], impacts=impacts, end=state,
        parameters=p, quiet=quiet[(first + np.arange(found)) % _MANY], swell=swell,
    )  # fmt: skip


def _course(knots: tuple[tuple[float, float], ...], begin: float) -> npt.NDArray[np.float64]:
    """Return a course, whose times count from the first sample, on the kernel's clock, shape (2, n)."""
    course = np.array(knots, dtype=np.float64).reshape(-1, 2).T.copy()
    course[0] += begin + LEAD
    return course
