"""What the second rig's instruments record, as a raw run or a run folder with its truth sealed beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline
from scipy.signal import lfilter

from benchmarks.second_rig._motion import Motion, move
from benchmarks.second_rig._settings import SecondRig
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import ChannelRow, RunForm, Stated, channels_text
from vines.rig.synth import RawRun, true_pattern, write_raw

Floats = npt.NDArray[np.float64]

_RANGE = 10.0
_STEP = 2 * _RANGE / 2**24
_G = 9.80665
_BRACKET = ((1350.0, 0.01, 0.5), (3100.0, 0.008, 0.5))
"""Structural modes that ring in the oscillator's accelerometer: frequency [Hz], damping ratio, participation."""
_FRAME = ((38.0, 0.008, 1.0), (112.0, 0.008, 0.5), (310.0, 0.01, 0.3))
"""Frame modes: what the lasers stand on and the sensors feel."""


def record(rig: SecondRig, run_id: str = "second", ringdowns: tuple[str, ...] = ()) -> RawRun:
    """Let the rig run and record it; the truth has the keys of the first rig's."""
    rng = np.random.default_rng([rig.seed, 5])
    motion = move(rig, rng)
    count = round(rig.duration * rig.rate)
    t = np.arange(count) / rig.rate
    frame = _ringing(rig, motion, _FRAME, rig.modes)
    channels, rows = [], []
    for name in rig.channels:
        values, volt, unit, u_gain, delay, corner = _sensor(rig, motion, name, t, frame, rng)
        volts = values * volt + rig.hum * np.sin(2 * np.pi * 50.0 * t + rng.uniform(0, 2 * np.pi))
        volts += 4e-5 * rng.normal(size=count)
        codes = np.clip(np.rint(volts / _STEP), -(2**23), 2**23 - 1).astype(np.int32)
        channels.append(RawChannel(f"daq/{name}", codes, "V", rig.rate, 0.0, about={"slope": repr(_STEP)}))
        rows.append(ChannelRow(
            name=name, role=name, quantity="displacement" if "disp" in name else "acceleration",
            dof="e" if "base" in name else "x1", file="run.tdms", field=f"daq/{name}", unit="V",
            sensitivity=volt / 1e3 if unit == "V/mm" else volt * _G * 1e3, sensitivity_unit=unit,
            u_sensitivity=u_gain, sign="+1", fs=rig.rate, t0=0.0, range=_RANGE, group_delay=delay, u_delay=2e-6,
            high_pass=corner, anti_alias=0.45 * rig.rate, bits=24, recorder="daq", sensor="second rig", serial=name,
            calibrated="2026-01-02",
        ))  # fmt: skip
    files = {"run.tdms": RawFile("tdms", tuple(channels), "2026-01-05T09:00:00Z")}
    return RawRun(_form(rig, run_id, ringdowns, rng), tuple(rows), files, _truth(rig, run_id, motion), np.zeros(0))


def write(folder: Path, rig: SecondRig, ringdowns: tuple[str, ...] = ()) -> RawRun:
    """Write a run folder, and its truth to ``sealed`` beside it."""
    run = record(rig, folder.name, ringdowns)
    (folder / "raw").mkdir(parents=True)
    (folder / "derived").mkdir()
    for name, file in run.files.items():
        write_raw(folder / "raw" / name, "tdms", file)
    text = msgspec.json.format(msgspec.json.encode(run.form), indent=2).decode()
    (folder / "run.json").write_text(text + "\n", encoding="utf-8")
    (folder / "channels.tsv").write_text(channels_text(run.rows), encoding="utf-8")
    sealed = folder.parent / "sealed"
    sealed.mkdir(exist_ok=True)
    (sealed / f"{folder.name}.json").write_text(json.dumps(run.truth, indent=1) + "\n", encoding="utf-8")
    return run


def _sensor(
    rig: SecondRig, motion: Motion, name: str, t: Floats, frame: tuple[Floats, Floats], rng: np.random.Generator
) -> tuple[Floats, float, str, float, float, float]:
    """Return what a sensor sees [SI], volts by it, unit and uncertainty of the sensitivity, delay, high-pass."""
    of_base = name.startswith("base")
    x, v = (motion.q, motion.dq) if of_base else (motion.x1, motion.v1)
    shake = 0.3 if of_base else 1.0
    if name.endswith("disp"):
        seen = CubicHermiteSpline(motion.t, x + shake * frame[0], v + shake * frame[1])(t - rig.laser_delay)
        span = next(each for each in (1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 1.0) if np.abs(seen).max() < 0.85 * each)
        place = seen / span
        seen = seen + rig.laser_bend * span * (place**3 - 0.6 * place + 0.3 * place**2)
        noise = rig.laser_noise * span / 0.02 * rng.normal(size=len(t))
        gain = 1 + 0.002 * rng.normal()
        return gain * seen + noise, _RANGE / span, "V/mm", 0.002, rig.laser_delay + 2e-6 * rng.normal(), 0.0
    h = motion.t[1] - motion.t[0]
    velocity = v + shake * frame[1]
    if not of_base:
        velocity = velocity + _ringing(rig, motion, _BRACKET, 1.0)[1]
    # A converter that integrates over its sample time shows the mean since the sample before.
    acceleration = np.diff(velocity, prepend=velocity[0]) / h
    corner = 0.5 * (1 + 0.01 * rng.normal())
    a = np.exp(-2 * np.pi * 0.5 * h)
    acceleration = lfilter([0.5 * (1 + a), -0.5 * (1 + a)], [1.0, -a], acceleration)
    seen = (1 + 0.01 * rng.normal()) * np.interp(t, motion.t, acceleration) + rig.acc_noise * rng.normal(size=len(t))
    scale = next(each for each in (1.0, 0.1, 0.01, 1e-3) if np.abs(seen).max() / _G * each < 9.0)
    return seen, scale / _G, "mV/g", 0.01, 0.5 / rig.rate, corner


def _ringing(
    rig: SecondRig, motion: Motion, modes: tuple[tuple[float, float, float], ...], size: float
) -> tuple[Floats, Floats]:
    """Return displacement and velocity of modes that the contacts strike, exactly between the samples."""
    h = motion.t[1] - motion.t[0]
    struck = np.diff(motion.pushed, prepend=motion.pushed[0]) / rig.M
    x, v = np.zeros(len(motion.t)), np.zeros(len(motion.t))
    if size:
        for f, z, share in modes:
            s = 2 * np.pi * f * complex(-z, np.sqrt(1 - z * z))
            # Complex amplitude Y: Y' = s Y + i struck'/Im s; displacement is its real part with the sign of the blow.
            y = lfilter([1.0], [1.0, -np.exp(s * h)], struck.astype(complex)) * size * share
            x += (y / s.imag).imag
            v += (s * y / s.imag).imag
    return x, v


def _form(rig: SecondRig, run_id: str, ringdowns: tuple[str, ...], rng: np.random.Generator) -> RunForm:
    def stated(true: float, u: float) -> Stated:
        return Stated(float(true + u * rng.normal()), u)

    still = rig.ringdown
    more: dict[str, Any] = {"tilt": {"value": 0.0, "u": 0.01}}
    if rig.friction_stated:
        u = 0.15 * rig.friction
        more["friction"] = {"value": float(rig.friction + u * rng.normal()), "u": u}
    return RunForm(
        run_id=run_id, start_utc="2026-01-05T09:00:00Z", protocol="ringdown" if still else "dwell",
        f_cmd=None if still else rig.f, E_cmd=None if still else rig.E, settle=rig.settle,
        M=stated(rig.M, 5e-4 * rig.M), m=stated(rig.m, 5e-4 * rig.m), b=stated(rig.b, 5e-5), ball=not still,
        temperature_before=20.0, temperature_after=20.0, ringdown=ringdowns, materials={"rig": "second"},
        licence="CC0-1.0", more=more,
    )  # fmt: skip


def _truth(rig: SecondRig, run_id: str, motion: Motion) -> dict[str, Any]:
    """Return what only the rig knows, with the keys of the first rig's truth."""
    rows = motion.rows
    inside = np.isfinite(rows["t_mid"]) & (rows["t_mid"] >= 0) & (rows["t_mid"] < rig.duration)
    rows = rows[inside]
    span = (motion.t >= 0) & (motion.t < rig.duration)
    omega0, omega = float(np.sqrt(rig.k / rig.M)), 2 * np.pi * rig.f
    r = rows["r"]
    impacts = {name: rows[name].tolist() for name in ("side", "x1", "v1", "x2", "v2", "w_dot", "w_dot_after", "r")}
    impacts = {"t": rows["t_mid"].tolist(), **impacts, "lag": (rows["t_mid"] - rows["t"]).tolist()}
    impacts["phase"] = ((omega * rows["t_mid"] + motion.parameters["phase"]) % (2 * np.pi)).tolist()
    still = rig.ringdown
    # Amplitude and phase of the first harmonic that the base has, whatever moves it.
    e = 2 * np.mean(motion.q[span] * np.exp(-1j * omega * motion.t[span])) if not still else 0.0
    E = float(abs(e))
    return {
        "run_id": run_id, "seed": rig.seed, "clock": {"pace": 1.0},
        "settings": {
            "r": rig.r, "r_speed": 1.0, "r_exponent": 0.0, "friction": rig.friction / _G, "b": rig.b,
            "tilt": float(np.degrees(np.arcsin(rig.tilt / _G))), "duration": rig.duration, "sigma_r": rig.sigma_r,
        },
        "parameters": {
            "mu": rig.m / rig.M, "A": E / rig.b, "Omega": None if still else omega / omega0,
            "r": float(np.mean(r)) if len(r) else None, "lam": rig.c / (rig.M * omega0), "omega0": omega0, "E": E,
            "f": None if still else rig.f, "phase": float(np.angle(e) + np.pi / 2), "M": rig.M, "m": rig.m, "b": rig.b,
            "sigma_r": float(np.std(r)) if len(r) else None,
        },
        "measures": {
            "max_abs_x1": float(np.abs(motion.x1[span]).max()), "rms_x1": float(np.std(motion.x1[span])),
            "kinetic_ratio": None if still else
            float(rig.m * np.mean(motion.v2[span] ** 2) / (rig.M * np.mean(motion.v1[span] ** 2))),
        },
        "pattern": None if still else true_pattern(rows["t_mid"], rows["side"], rig.f, rig.duration),
        "impacts": impacts,
    }  # fmt: skip
