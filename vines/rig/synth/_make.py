"""A synthetic run, in memory or as a run folder, and its sealed truth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from vines.errors import StoreError
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest import ChannelRow, RunForm, Stated, assemble, channels_text
from vines.rig.recording import Recording
from vines.rig.synth._film import film
from vines.rig.synth._instruments import LEAD, SPARE, STEP, recorders, signals
from vines.rig.synth._motion import Motion, move
from vines.rig.synth._pattern import true_pattern
from vines.rig.synth._settings import RigSettings
from vines.rig.synth._write import file_name, write_raw

__all__ = ["RawRun", "make_run", "raw_run", "read_raw", "simulate_rig"]

_COURSES = ("E_course", "r_course")
"""Settings that the truth leaves out where they are empty."""


@dataclass(frozen=True, slots=True, eq=False)
class RawRun:
    """A synthetic run as a laboratory has it, and its truth.

    Attributes
    ----------
    form, rows
        ``run.json`` and ``channels.tsv``.
    files : mapping of str to RawFile
        Raw files by name; samples are steps of the converter, with their ``slope`` in ``about``.
    truth : dict
        What the laboratory does not know; JSON.
    end : ndarray
        State at the end, from which another run can go on.
    """

    form: RunForm
    rows: tuple[ChannelRow, ...]
    files: Mapping[str, RawFile]
    truth: dict[str, Any]
    end: np.ndarray


def raw_run(settings: RigSettings, seed: int, state: np.ndarray | None = None) -> RawRun:
    """Simulate a run and record it.

    Parameters
    ----------
    settings : RigSettings
        The rig.
    seed : int
        Of everything that is drawn.
    state : ndarray, optional
        End of the run before.

    Raises
    ------
    ParameterError
        If a rig cannot be so.
    """
    s = settings.check()
    rng = np.random.default_rng(np.random.SeedSequence([seed, 88]))
    boxes = recorders(s)
    step = boxes[0].pace / s.rate
    motion = move(s, rng, step, round((LEAD + SPARE) / step), state)
    seen = signals(s, motion, rng)
    kept: dict[str, list[RawChannel]] = {}
    rows = []
    for each in seen:
        several = each.recorder if s.recorders == 2 else ""
        name = file_name(s.form, several)
        field = f"{each.recorder}/{each.name}" if s.form == "tdms" else each.name
        kept.setdefault(name, []).append(
            RawChannel(field, each.codes, "V", s.rate, each.late / s.rate, about={"slope": repr(STEP)})
        )
        rows.append(
            ChannelRow(
                name=each.name,
                role=each.role,
                quantity=each.quantity,
                dof=each.dof,
                file=name,
                field=field,  # pyright: ignore[reportArgumentType]
                unit="V",
                sensitivity=each.sensitivity,
                sensitivity_unit=each.unit,
                u_sensitivity=each.u_sensitivity,
                sign="+1",
                fs=s.rate,
                t0=each.late / s.rate,
                range=10.0,
                group_delay=each.group_delay,
                u_delay=each.u_delay,
                high_pass=each.high_pass,
                anti_alias=0.45 * s.rate,
                bits=24,
                recorder=each.recorder,
                sensor=each.sensor,
                serial=f"synthetic-{each.role}",
                calibrated="2026-01-02",
            )
        )
    files = {name: RawFile(s.form, tuple(channels), s.start_utc) for name, channels in kept.items()}
    if s.camera is not None:
        fault = s.fault if s.fault_channel == "ball_cam" else "none"
        row, filmed = film(s.camera, motion, LEAD, s.duration, seed, fault)
        files[row.file] = filmed
        rows.append(row)
    return RawRun(_form(s, rng), tuple(rows), files, _truth(s, seed, motion, step), motion.end)


def simulate_rig(settings: RigSettings, seed: int, state: np.ndarray | None = None) -> tuple[Recording, dict[str, Any]]:
    """Return a synthetic run as ingest would read it, without any file, and its truth.

    Parameters
    ----------
    settings, seed, state
        As of :func:`raw_run`.

    Returns
    -------
    recording : Recording
        The run in SI.
    truth : dict
        As in ``truth.json`` (docs/rig.md).

    Raises
    ------
    ParameterError
        If a rig cannot be so.
    RigError
        If ingest refuses the run, as it must with planted faults.
    """
    run = raw_run(settings, seed, state)
    return read_raw(run), run.truth


def read_raw(run: RawRun) -> Recording:
    """Return a raw run as ingest would read it, without any file.

    Raises
    ------
    RigError
        If ingest refuses it.
    """
    files = {
        name: RawFile(file.form, tuple(_in_volts(each) for each in file.channels), file.started)
        for name, file in run.files.items()
    }
    return assemble(run.form, run.rows, files, {}).recording


def _in_volts(channel: RawChannel) -> RawChannel:
    values = np.asarray(channel.values, np.float64) * float(channel.about["slope"])
    return RawChannel(channel.name, values, channel.unit, channel.rate, channel.start, channel.times)


def make_run(
    folder: Path, settings: RigSettings, seed: int, state: np.ndarray | None = None, sealed: Path | None = None
) -> RawRun:
    """Write a synthetic run as a run folder, and its truth beside it in ``sealed/<run_id>.json``.

    Parameters
    ----------
    folder : Path
        The run folder, which must not exist.
    settings, seed, state
        As of :func:`raw_run`.
    sealed : Path, optional
        Folder of the truth; ``sealed`` beside the run folder if left out.

    Raises
    ------
    StoreError
        If the folder exists.
    ParameterError
        If a rig cannot be so.
    """
    if folder.exists():
        raise StoreError(f"{folder} exists already; choose another folder or remove it")
    run = raw_run(settings, seed, state)
    (folder / "raw").mkdir(parents=True)
    (folder / "derived").mkdir()
    for name, file in run.files.items():
        write_raw(folder / "raw" / name, file.form, file)
    text = msgspec.json.format(msgspec.json.encode(run.form), indent=2).decode()
    (folder / "run.json").write_text(text + "\n", encoding="utf-8")
    (folder / "channels.tsv").write_text(channels_text(run.rows), encoding="utf-8")
    sealed = sealed or folder.parent / "sealed"
    sealed.mkdir(exist_ok=True)
    (sealed / f"{folder.name}.json").write_text(json.dumps(run.truth, indent=1) + "\n", encoding="utf-8")
    return run


def _form(s: RigSettings, rng: np.random.Generator) -> RunForm:
    """Return what the laboratory states: masses and lengths as weighed and gauged, the command as given."""
    error = rng.normal(size=3)
    still = s.protocol == "ringdown"
    weighed = [
        Stated(float(true * (1 + s.u_mass * e)), s.u_mass * true) for true, e in ((s.M, error[0]), (s.m, error[1]))
    ]
    gauged = Stated(float(s.b + s.u_b * error[2]), s.u_b)
    # The roll-down test of the laboratory gives the ball's deceleration to 15 %.
    rubbed = s.friction * 9.80665
    friction = {"value": float(rubbed * (1 + 0.15 * rng.normal())), "u": 0.15 * rubbed}
    # A sensor on the frame follows the springs' temperature to a tenth of a kelvin.
    before, after = (float(true + s.u_temperature * rng.normal()) for true in s.temperature)
    return RunForm(
        run_id=s.run_id, start_utc=s.start_utc, protocol=s.protocol, f_cmd=None if still else s.f,
        E_cmd=None if still else s.E, settle=s.settle, M=weighed[0], m=weighed[1], b=gauged, ball=s.ball,
        temperature_before=before, temperature_after=after, ringdown=s.ringdown,
        materials={"rig": "synthetic"}, licence="CC0-1.0", more={"friction": friction},
    )  # fmt: skip


def _truth(s: RigSettings, seed: int, motion: Motion, step: float) -> dict[str, Any]:
    """Return what only the synthetic rig knows, in JSON; times on the clock of the run."""
    p = motion.parameters
    pace = step * s.rate
    rows = motion.impacts
    # An impact is where its force has its centroid; one that still lasts at the end of the record has none.
    t = (rows["t_mid"] - LEAD) / pace
    kept = np.isfinite(rows["t_end"]) & (t >= 0) & (t < s.duration)
    # The truth counts from the first sample; a fault of the clock is not in it.
    i = round(LEAD / step) + np.arange(round(s.duration * s.rate))
    warm = s.softening * (0.5 * (p["T0"] + p["T1"]))
    omega0 = float(np.sqrt(s.k / s.M)) * (1 + warm)
    omega = p["omega"]
    phase0 = float((omega * (LEAD + motion.start) + p["phi"]) % (2 * np.pi))
    impacts = {
        name: rows[name][kept].tolist() for name in ("side", "x1", "v1", "x2", "v2", "w_dot", "w_dot_after", "r")
    }
    impacts = {"t": t[kept].tolist(), **impacts}
    impacts["contact_time"] = (rows["t_end"] - rows["t"])[kept].tolist()
    impacts["lag"] = (rows["t_mid"] - rows["t"])[kept].tolist()
    impacts["phase"] = ((omega * pace * t[kept] + phase0) % (2 * np.pi)).tolist()
    r = rows["r"][kept]
    v1, v2 = motion.v1[i], motion.v2[i]
    still = s.protocol == "ringdown"
    return {
        "run_id": s.run_id,
        "seed": seed,
        "settings": {
            name: v for name, v in msgspec.to_builtins(s).items() if v is not None and (v or name not in _COURSES)
        },
        "clock": {"pace": pace},
        "parameters": {
            "mu": s.m / s.M, "A": p["E"] / s.b, "Omega": None if still else omega / omega0,
            "r": float(np.mean(r)) if len(r) else None, "r_median": float(np.median(r)) if len(r) else None,
            "sigma_r": float(np.std(r)) if len(r) else None, "lam": s.c / (s.M * omega0), "omega0": omega0 * pace,
            "E": p["E"], "f": None if still else omega * pace / (2 * np.pi), "phase": phase0,
            "M": s.M, "m": s.m, "b": s.b,
        },
        "measures": {
            "max_abs_x1": float(np.abs(motion.x1[i]).max()), "rms_x1": float(np.std(motion.x1[i])),
            "kinetic_ratio": float(s.m * np.mean(v2**2) / (s.M * np.mean(v1**2))) if s.ball else None,
        },
        "pattern": None if still else true_pattern(t[kept], rows["side"][kept], omega * pace / (2 * np.pi), s.duration),
        "faults": [] if s.fault == "none" else [{"kind": s.fault, "channel": s.fault_channel}],
        "impacts": impacts,
    }  # fmt: skip
