"""Synthetic runs over the ranges of a real rig, one a seed, reconstructed, compared and laid beside their truth."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

import vines
from vines.attractors import settle_from
from vines.errors import VinesError
from vines.rig import Comparison, Reconstruction, compare, reconstruct, ring_down
from vines.rig.ingest import ChannelRow, Stated
from vines.rig.synth import LEAST, MOST, RawRun, RigSettings, draw_settings, raw_run, read_raw

KINDS = (
    "drawn", "drawn", "drawn", "drawn", "laser only", "accelerometers only", "2:1", "asymmetric 1:1", "2:2/2T",
    "high mu", "chaotic", "mixed",
)  # fmt: skip
"""Kind of run of a seed, by its remainder."""

FAULTS = (
    "sign of lo_disp", "sign of lo_acc", "sign of base_disp", "sign of base_acc", "sign of both on the base",
    "sign of both on the oscillator", "unit of lo_disp", "unit of lo_acc", "unit of base_disp", "unit of base_acc",
    "clock", "clocks of two recorders", "sensitivity of lo_disp x 2", "sensitivity of all x 2", "gap b + 5 %",
    "mass of the ball + 10 %", "mass of the oscillator - 10 %", "delay of lo_disp 2 ms", "rate + .5 %",
)  # fmt: skip
"""What is planted."""


def settings_of(seed: int, duration: float = 60.0) -> tuple[str, RigSettings]:
    """Return the kind of a seed's run and its settings, all drawn from the seed."""
    kind = KINDS[seed % len(KINDS)]
    rng = np.random.default_rng([seed, 77])

    def even(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    quiet: dict[str, Any] = {
        "sigma_r": even(0.005, 0.007), "friction": even(0.001, 0.003), "m": 3.807 * 0.01, "f": 8.815555, "r": 0.65,
        "r_speed": 1.2, "sag": 0.0, "tilt": even(-0.03, 0.03),
    }  # fmt: skip
    given: dict[str, Any] = {"duration": duration}
    match kind:
        case "laser only":
            given |= {"channels": ("base_disp", "lo_disp"), "recorders": 1}
        case "accelerometers only":
            given |= {"channels": ("base_acc", "lo_acc"), "recorders": 1}
        case "2:1":
            # Where r falls little with speed 2:1 holds through the least scatter of real contacts.
            given |= quiet | {"E": 0.015 * even(0.0225, 0.0232), "r_exponent": even(0.05, 0.1)}
        case "asymmetric 1:1":
            given |= quiet | {"E": 0.015 * even(0.0186, 0.0200)}
        case "2:2/2T":
            # Below the range of real scatter: at .005 the doubling is washed out.
            given |= quiet | {"E": 0.015 * even(0.0206, 0.0211), "sigma_r": even(0.0005, 0.001)}
        case "high mu":
            given |= {"m": 3.807 * even(0.03, 0.1), "E": 0.015 * even(0.03, 0.06)}
        case "chaotic":
            given |= quiet | {"E": 0.015 * even(0.028, 0.034)}
        case "mixed":
            given |= {**quiet, "E": 0.015 * even(0.023, 0.026), "sigma_r": even(0.025, 0.05)}
        case _:
            pass
    return kind, draw_settings(seed, **given)


def rest_of(settings: RigSettings, when: float) -> RigSettings:
    """Return the ring-down of the same rig at a temperature."""
    return msgspec.structs.replace(
        settings, run_id=f"ringdown_{when:.3f}".replace(".", "_"), protocol="ringdown", ball=False, E=0.0, settle=0.0,
        duration=15.0, start=(0.012, 0.0, 0.0, 0.0), recorders=1, temperature=(when, when), false=0.0, dropouts=0.0,
        fault="none",
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Scored:
    """A run and how near it came to its truth."""

    seed: int
    kind: str
    refused: str
    accepted: bool
    reasons: str
    verdict: str
    reason: str
    pattern: str
    true_pattern: str
    true_fraction: float
    regime: str
    errors: dict[str, float]
    ratios: dict[str, float]
    e_n: dict[str, float]
    impacts: int
    missed: int
    false: int


def score(seed: int, duration: float = 60.0) -> Scored:
    """Make, read, reconstruct and compare the run of a seed."""
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    kind, settings = settings_of(seed, duration)
    raw = raw_run(settings, seed)
    truth = raw.truth
    empty = Scored(
        seed, kind, "", False, "", "refused", "", "", truth["pattern"]["name"], truth["pattern"]["fraction"],
        regime_of(truth), {}, {}, {}, 0, 0, 0,
    )  # fmt: skip
    try:
        free = [
            ring_down(read_raw(raw_run(rest_of(settings, when), seed + 500_000 + k)))
            for k, when in enumerate(settings.temperature)
        ]
        found = reconstruct(read_raw(raw), free)
    except VinesError as error:
        return replace(empty, refused=str(error))
    told = compare(found)
    return judged(empty, found, told, truth)


def judged(empty: Scored, found: Reconstruction, told: Comparison, truth: dict[str, Any]) -> Scored:
    """Lay a reconstruction beside the truth."""
    true = true_values(truth)
    t = np.array(truth["impacts"]["t"])
    own = t[(t > found.impacts["t"][0] - 1e-3) & (t < found.impacts["t"][-1] + 1e-3)]
    near, met = paired(own, found.impacts["t"])
    apart = found.impacts["t"][met] - own[near]
    # A recorder of its own may begin before the clock of the run, from which the truth counts.
    within = np.count_nonzero((found.impacts["t"] >= 0) & (found.impacts["t"] < truth["settings"]["duration"]))
    q = found.quantities
    # A mean is compared with that of the impacts it was taken from; impacts in a chatter give no restitution.
    taken = np.isfinite(found.impacts["r"][met]) & ~found.impacts["suspect"][met]
    inside = np.flatnonzero((t > found.impacts["t"][0] - 1e-3) & (t < found.impacts["t"][-1] + 1e-3))
    chosen = inside[near[taken]]
    true["w_before"] = float(np.mean(np.abs(np.array(truth["impacts"]["w_dot"])[chosen])))
    errors = {
        "r_mean": q["r_mean"].value - true["r_mean"],
        "r": q["r"].value - true["r"],
        "sigma_r": q["sigma_r"].value / true["sigma_r"] - 1,
        "mu": q["mu_momentum"].value / true["mu"] - 1,
        "t_rms": float(np.sqrt(np.mean(apart**2))) if len(apart) else np.nan,
        "t_95": float(np.quantile(np.abs(apart), 0.95)) if len(apart) else np.nan,
    }
    ratios = {}
    for name, value in true.items():
        if name in q and q[name].u > 0:
            gap = q[name].value - value
            if name in ("phase", "impact_phase"):
                gap = float(np.angle(np.exp(1j * gap)))
            ratios[name] = gap / q[name].u
    ratios["mu_momentum"] = (q["mu_momentum"].value - true["mu"]) / q["mu_momentum"].u
    best = told.branches[0] if told.branches else None
    return replace(
        empty, accepted=found.accepted, reasons=found.reasons, verdict=told.verdict, reason=told.reason,
        pattern=found.pattern.name, errors=errors, ratios=ratios, e_n=dict(best.errors) if best else {},
        impacts=len(own), missed=len(own) - len(near), false=int(within) - len(met),
    )  # fmt: skip


def true_values(truth: dict[str, Any]) -> dict[str, float]:
    """Return the true values of reconstructed quantities."""
    s, p = truth["settings"], truth["parameters"]
    w, r = np.abs(truth["impacts"]["w_dot"]), np.array(truth["impacts"]["r"])
    scatter = r - s["r"] * (w / s["r_speed"]) ** -s["r_exponent"]
    # The softest impacts are put at the largest restitution that the contact knows: that is no scatter.
    drawn = (r > LEAST) & (r < MOST)
    # The straight lines before and after a contact meet at the centroid of its force, the ball this deep in the wall.
    b = s["b"] + float(np.sum(w * np.array(truth["impacts"]["lag"])) / len(w))
    return {
        "f": p["f"], "E": p["E"], "phase": p["phase"], "omega0": p["omega0"], "lam": p["lam"], "Omega": p["Omega"],
        "A": p["E"] / b, "b": b, "mu": p["mu"], "friction": s["friction"] * 9.80665,
        "tilt": 9.80665 * float(np.sin(np.radians(s["tilt"]))),
        "r": float(np.sum(r * w) / np.sum(w)), "r_mean": float(np.mean(r)),
        "r_exponent": -s["r_exponent"], "sigma_r": float(np.std(scatter[drawn])), "w_before": float(np.mean(w)),
        "kinetic_ratio": truth["measures"]["kinetic_ratio"],
    }  # fmt: skip


def regime_of(truth: dict[str, Any]) -> str:
    """Return what the model without scatter does at the true parameters, from the last impact of the run."""
    p, impacts, scale = truth["parameters"], truth["impacts"], truth["parameters"]["b"] * truth["parameters"]["omega0"]
    params = vines.Params(**{k: p[k] for k in ("mu", "A", "Omega", "lam")}, r=min(p["r"], 1.0))
    x1, side, phase = (float(impacts[name][-1]) for name in ("x1", "side", "phase"))
    v1, w = (float(impacts[name][-1]) / scale for name in ("v1", "w_dot"))
    gain = (1 + params.r) * w / (1 + params.mu)
    start = {"x1": x1 / p["b"], "v1": v1 - params.mu * gain, "x2": x1 / p["b"] - side, "v2": v1 - w + gain}
    found = settle_from(params, start | {"phase": phase})
    return f"{found.name}" if found.regime == "periodic" else found.regime


def paired(
    true: npt.NDArray[np.float64], seen: npt.NDArray[np.float64], reach: float = 1e-3
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return which true and seen impacts are each other's nearest within `reach` [s]."""
    if not len(true) or not len(seen):
        return np.zeros(0, np.intp), np.zeros(0, np.intp)
    to_seen = np.array([int(np.argmin(np.abs(seen - t))) for t in true])
    to_true = np.array([int(np.argmin(np.abs(true - t))) for t in seen])
    here = np.flatnonzero((to_true[to_seen] == np.arange(len(true))) & (np.abs(seen[to_seen] - true) < reach))
    return here, to_seen[here]


def planted(seed: int, fault: str, duration: float = 20.0) -> tuple[str, str]:
    """Return the verdict on a good run with a planted fault, or ``refused``, and why."""
    settings = msgspec.structs.replace(
        draw_settings(seed, duration=duration, recorders=1, E=0.015 * 0.016, sag=0.0, sigma_r=0.01, friction=0.002),
        run_id=f"fault_{FAULTS.index(fault):02d}",
    )
    if fault == "clock":
        settings = msgspec.structs.replace(settings, fault="clock")
    if fault == "clocks of two recorders":
        settings = msgspec.structs.replace(settings, recorders=2, offset_second=0.03)
    free = [ring_down(read_raw(raw_run(rest_of(settings, settings.temperature[0]), seed + 500_000)))]
    try:
        found = reconstruct(read_raw(spoilt(raw_run(settings, seed), fault)), free)
    except VinesError as error:
        return "refused", str(error)
    told = compare(found)
    return told.verdict, told.reason


def spoilt(raw: RawRun, fault: str) -> RawRun:
    """Return a raw run whose papers say something wrong."""

    def rows(names: tuple[str, ...], **change: Any) -> RawRun:
        new = tuple(_changed(row, **change) if row.role in names else row for row in raw.rows)
        return replace(raw, rows=new)

    def form(**change: Stated) -> RawRun:
        return replace(raw, form=msgspec.structs.replace(raw.form, **change))

    stated = raw.form
    base, body = ("base_disp", "base_acc"), ("lo_disp", "lo_acc")
    match fault.split(" ", maxsplit=1)[0], fault:
        case "sign", "sign of both on the base":
            return rows(base, sign="-1")
        case "sign", "sign of both on the oscillator":
            return rows(body, sign="-1")
        case "sign", _:
            return rows((fault.rsplit(maxsplit=1)[-1],), sign="-1")
        case "unit", _:
            name = fault.rsplit(maxsplit=1)[-1]
            # mV/g read as mV/(m/s^2), V/mm as V/cm.
            return rows((name,), unit_of_sensitivity=None)
        case "sensitivity", "sensitivity of all x 2":
            return rows((*base, *body), factor=2.0)
        case "sensitivity", _:
            return rows(("lo_disp",), factor=2.0)
        case "gap", _:
            return form(b=Stated(stated.b.value * 1.05, stated.b.u))
        case "mass", "mass of the ball + 10 %":
            return form(m=Stated(stated.m.value * 1.1, stated.m.u))
        case "mass", _:
            return form(M=Stated(stated.M.value * 0.9, stated.M.u))
        case "delay", _:
            return rows(("lo_disp",), late=2e-3)
        case "rate", _:
            return rows((*base, *body), pace=1.005)
        case "clocks", _:
            # The copy of the base accelerometer that joins the clocks is wired the other way round.
            return replace(raw, rows=tuple(_changed(r, sign="-1") if r.name == "base_sync" else r for r in raw.rows))
        case _:
            return raw


def _changed(
    row: ChannelRow, *, factor: float = 1.0, late: float = 0.0, pace: float = 1.0, **change: Any
) -> ChannelRow:
    if "unit_of_sensitivity" in change:
        change = {"sensitivity_unit": {"mV/g": "mV/(m/s^2)", "V/mm": "V/cm"}[row.sensitivity_unit]}
    assert isinstance(row.sensitivity, float)
    assert isinstance(row.fs, float)
    change |= {
        "sensitivity": row.sensitivity / factor, "group_delay": row.group_delay + late, "fs": row.fs * pace,
    }  # fmt: skip
    return msgspec.structs.replace(row, **change)
