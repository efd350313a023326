"""From a rig to its true motion at the samples of a recorder."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from benchmarks.second_rig._integrator import NAMES, ROWS, N, base, damping_ratio, run, stiffness
from benchmarks.second_rig._settings import CUBIC_AT, G, SecondRig

Floats = npt.NDArray[np.float64]

LEAD = 2.0
"""[s] Before the first sample, in which the couplings of sensors settle."""
_TAIL = 0.05
_TOLERANCE = 1e-8
_MANY = 40_000
_SHAKER = 38.0
"""[Hz] Table on the shaker's suspension."""
_FREE = 1.5
"""[Hz] Table on a soft suspension."""


@dataclass(frozen=True, eq=False)
class Motion:
    """True motion, at `t` [s] after the first sample of the record.

    Attributes
    ----------
    t, x1, v1, q, dq, pushed : ndarray, shape (n,)
        Oscillator, base, and impulse of the contacts on the oscillator so far [N s].
    v2 : ndarray
        Of the ball.
    rows : structured ndarray
        Contacts, see `ROWS`; times likewise.
    parameters : dict
        Of the integrator.
    """

    t: Floats
    x1: Floats
    v1: Floats
    v2: Floats
    q: Floats
    dq: Floats
    pushed: Floats
    rows: npt.NDArray[np.void]
    parameters: dict[str, float]


def parameters(rig: SecondRig, rng: np.random.Generator) -> dict[str, float]:
    """Return the parameters of the integrator."""
    phi, phi2, phi3 = rng.uniform(0, 2 * np.pi, 3)
    free = rig.ringdown and rig.table == "free"
    p = {
        "M": rig.M, "c": rig.c, "k": rig.k, "k3": rig.cubic / CUBIC_AT**2, "mu": rig.m / rig.M,
        "friction": rig.rolling * G if rig.rolling else rig.friction, "slip": 2e-3, "spins": float(rig.rolling > 0),
        "pull": rig.tilt, "left": rig.b, "right": rig.b, "kc": 0.0, "E": 0.0 if rig.ringdown else rig.E,
        "omega": 2 * np.pi * rig.f, "phi": phi, "h2": rig.h2, "phi2": phi2, "h3": rig.h3, "phi3": phi3,
        "drift_E": rig.drift_E, "soft": rig.drift_omega0, "begin": rig.settle, "span": rig.duration,
        "Mb": 1.0, "kb": 0.0, "cb": 0.0, "reacts": 0.0, "ball": float(not rig.ringdown), "m": rig.m,
    }  # fmt: skip
    if rig.compliance:
        stiff = rig.k / rig.compliance
        w = 2 * np.pi * _SHAKER
        p |= {"reacts": 1.0, "kb": stiff, "Mb": stiff / w**2, "cb": 0.2 * stiff / w}
    if free:
        w = 2 * np.pi * _FREE
        p |= {"reacts": 1.0, "Mb": rig.table_mass, "kb": rig.table_mass * w**2, "cb": 0.1 * rig.table_mass * w}
    p["kc"] = stiffness(rig.contact_time, rig.r, rig.M * rig.m / (rig.M + rig.m))
    return p


def move(rig: SecondRig, rng: np.random.Generator) -> Motion:
    """Let the rig settle and record it."""
    p = parameters(rig, rng)
    values = np.array([p[name] for name in NAMES])
    reduced = rig.M * rig.m / (rig.M + rig.m)
    restitutions = np.linspace(0.02, 0.99, 400)
    table = np.array([damping_ratio(each) for each in restitutions])
    state = np.zeros(N)
    state[:4] = (0.012, 0.0, 0.012, 0.0) if rig.ringdown else (0.0, 0.0, 0.0, 0.08)
    step = 1 / rig.rate
    lead = LEAD if not rig.ringdown else 0.2
    count = round((lead + rig.duration + _TAIL) * rig.rate)
    out, rows, at, begin = np.empty((count + 1, N)), np.empty((_MANY, len(ROWS))), 0, 0.0
    plan = [(rig.settle - lead, 0.05, np.empty((round((rig.settle - lead) / 0.05) + 1, N)))] if rig.settle else []
    plan.append((0.0, step, out))
    if rig.compliance and not rig.ringdown:
        # The table starts where the force of the first instant holds it nearly, so that it rings little.
        state[5], state[6] = base(0.0, values)
    for _, pace, into in plan:
        # What r drifts by is known by the time of a contact, which comes about twice a period.
        expected = np.arange(_MANY) / (2 * rig.f) - (rig.settle - begin)
        r = rig.r + rig.sigma_r * rng.normal(size=_MANY)
        if into is out and rig.drift_r:
            r = r + rig.drift_r * np.clip((expected - lead) / rig.duration, 0.0, 1.0)
        r = np.clip(r, 0.03, 0.98)
        zeta = np.interp(r, restitutions, table)
        dashpots = np.stack([r, 2 * zeta * np.sqrt(values[NAMES.index("kc")] * reduced)], axis=1)
        found = run(state, begin, values, pace, len(into) - 1, dashpots, _TOLERANCE, into, rows, at)
        state, begin = into[-1].copy(), begin + pace * (len(into) - 1)
    first = begin - step * count + lead
    kept = np.zeros(found, [(name, "f8") for name in ROWS])
    for i, name in enumerate(ROWS):
        kept[name] = rows[:found, i]
    for name in ("t", "t_end", "t_mid"):
        kept[name] -= first
    t = np.arange(count + 1) * step - lead
    q, dq = out[:, 5], out[:, 6]
    if not p["reacts"]:
        sizes = np.array([base(each, values) for each in t + first])
        q, dq = sizes[:, 0], sizes[:, 1]
    p["phase"] = float((p["omega"] * first + p["phi"]) % (2 * np.pi))
    return Motion(t, out[:, 0], out[:, 1], out[:, 3], q, dq, out[:, 7], kept, p)
