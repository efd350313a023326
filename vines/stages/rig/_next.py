"""What to measure next, of run folders or of a pipeline, and its picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import FileMissingError, RigError, UnknownNameError, nearest
from vines.rig import load_reconstruction, plan_runs
from vines.stages.api._home import Home, current
from vines.stages.rig._by_hand import each_of, is_campaign, reconstruct_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import StableBand
    from vines.rig import Plan, Reconstruction

__all__ = ["Next", "next_runs", "reconstructions_of", "suggestion_rows", "table_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Next:
    """A plan, and why runs could not be used for it.

    Attributes
    ----------
    plan : Plan
    lost : mapping of str to str
        Reason by run.
    """

    plan: Plan
    lost: dict[str, str]

    def figure(self) -> Figure:
        """Draw the plane of A and Omega with branches, runs and suggestions."""
        return _figure(self.plan)


def next_runs(source: str | Path, *, study: Home | None = None, **asked: Any) -> Next:
    """Return what to measure next.

    Parameters
    ----------
    source : str or Path
        A folder of runs or one run, which are reconstructed, or the name of a pipeline that has done so.
    study : Home, optional
        Whose; the one that the current folder belongs to if left out.
    **asked
        As for :func:`vines.rig.plan_runs`.

    Raises
    ------
    RigError
        If no run could be used.
    UnknownNameError, FileMissingError
        If there is no such folder or pipeline.
    """
    runs, lost = reconstructions_of(source, study=study)
    if not runs:
        why = "; ".join(f"{name}: {reason}" for name, reason in lost.items())
        raise RigError(f"{source}: no run could be used" + (f" ({why})" if why else ""))
    return Next(plan_runs(runs, **asked), lost)


def reconstructions_of(source: str | Path, *, study: Home | None = None) -> tuple[list[Reconstruction], dict[str, str]]:
    """Return the reconstructed runs of a folder or of a pipeline, in the order of time, and why others are not there.

    Raises
    ------
    UnknownNameError, FileMissingError
        If there is no such folder or pipeline.
    """
    study = study or current()
    folder = Path(source)
    if folder.is_dir():
        if is_campaign(folder):
            made = list(each_of(folder, lambda run: reconstruct_run(run, study=study), study))
            runs = [one.found for _, one, _ in made if one is not None]
            lost = {name: why for name, one, why in made if one is None}
        else:
            runs, lost = [reconstruct_run(folder, study=study).found], {}
    else:
        runs, lost = _of_pipeline(str(source), study)
    return sorted(runs, key=lambda run: (run.run.start_utc, run.run.run_id)), lost


def _of_pipeline(name: str, study: Home) -> tuple[list[Reconstruction], dict[str, str]]:
    pinned, _ = study.store.readable_pins()
    if name not in pinned:
        if "/" in name or "\\" in name:
            raise FileMissingError(f"{name}: there is no such folder of runs")
        raise UnknownNameError(f"{name!r} is no folder of runs and no pipeline that was run: {nearest(name, pinned)}")
    runs: list[Reconstruction] = []
    lost: dict[str, str] = {}
    for pin in pinned[name].values():
        if study.store.problem(pin["result"]):
            continue
        result = study.store.result(pin["result"])
        if "reconstructions" not in result.tables:
            continue
        runs += [load_reconstruction(path) for path in sorted((result.folder / "reconstructions").glob("*.npz"))]
        for row in result.table("reconstructions").to_pylist():
            if row["status"] == "failed":
                lost[row["run_id"]] = row["reason"]
    if not runs and not lost:
        raise RigError(f"pipeline {name!r} has no stage of kind reconstruct; 'vines rig reconstruct FOLDER' makes one")
    return runs, lost


def suggestion_rows(plan: Plan) -> list[dict[str, Any]]:
    """Return suggestions as rows for a machine: numbers in SI, uncertainties in the units of the quantities."""
    rows = []
    for number, one in enumerate(plan.suggestions, 1):
        row: dict[str, Any] = {
            "number": number, "kind": one.purpose, "A": one.A, "Omega": one.Omega, "f": one.f, "E": one.E,
            "E_cmd": one.E_cmd, "voltage": one.volts if np.isfinite(one.volts) else None,
            "branches": list(one.branches), "bits": one.bits, "dwells": plan.dwells, "length": plan.known.length,
        }  # fmt: skip
        row |= {f"u_{name}": u for name, u in one.before.items()}
        row |= {f"u_{name}_after": u for name, u in one.after.items()}
        rows.append(row | {"near": one.near, "reason": one.reason})
    return rows


def _figure(plan: Plan) -> Figure:
    from vines.figures import PlaneMark, rig_next_figure

    known = plan.known
    omega = np.array([column.Omega for column in plan.columns])
    tops = [
        edge for column in plan.columns for one in column.stretches for edge in (one.low, one.high)
    ] + plan.measured[:, 0].tolist()
    step = float(omega[1] - omega[0])
    window = ((float(omega[0] - step / 2), float(omega[-1] + step / 2)), (0.98 * min(tops), 1.02 * max(tops)))
    marks = [
        PlaneMark(number, one.Omega, one.A, one.purpose == "jump") for number, one in enumerate(plan.suggestions, 1)
    ]
    p = known.params
    return rig_next_figure(
        _bands(plan), plan.measured, marks, window=window,
        units=(known.values["omega0"] / (2 * np.pi), 1e3 * known.values["b"]),
        caption=f"Stable branches at mu = {p.mu:.5f}, r = {p.r:.4f}, lam = {p.lam:.5f}",
    )  # fmt: skip


def _bands(plan: Plan) -> list[StableBand]:
    """Return stretches of neighbouring columns that overlap as bands."""
    from vines.figures import StableBand

    open_: list[list[tuple[float, Any]]] = []
    done: list[list[tuple[float, Any]]] = []
    for column in plan.columns:
        taken: list[list[tuple[float, Any]]] = []
        for one in column.stretches:
            like = [
                band
                for band in open_
                if (band[-1][1].word, band[-1][1].symmetric) == (one.word, one.symmetric)
                and _near(band[-1][1], one)
                and not any(band is other for other in taken)
            ]
            band = like[0] if like else []
            band.append((column.Omega, one))
            taken.append(band)
        done += [band for band in open_ if not any(band is other for other in taken)]
        open_ = taken
    found = []
    for band in (*done, *open_):
        omega, low, high = np.array([(at, one.low, one.high) for at, one in band]).T
        first = band[0][1]
        found.append(StableBand(_name(first), _kind(first), omega, low, high))
    return found


def _near(one: Any, other: Any) -> bool:
    """Say whether two stretches of neighbouring columns are of one region, which may be narrower than it moves."""
    apart = abs(one.low + one.high - other.low - other.high) / 2
    return apart < 1.5 * (one.high - one.low + other.high - other.low)


def _name(one: Any) -> str:
    if one.name == "1:1":
        return "1:1" if one.symmetric else "1:1 asymmetric"
    return one.name


def _kind(one: Any) -> str:
    n, m = one.name.split("/")[0].split(":")
    if "/" in one.name:
        return "p > 1 periods"
    if n != m:
        return "n:m, n ≠ m"
    if n == "1":
        return "1:1, symmetric" if one.symmetric else "1:1, asymmetric"
    return "n:n, n > 1"


def table_of(plan: Plan) -> tuple[list[str], Sequence[list[str]]]:
    """Return head and cells of the table that a person reads."""
    volts = any(np.isfinite(one.volts) for one in plan.suggestions)
    head = ["", "what", "A", "Omega", "f [Hz]", "E [mm]", "command [mm]"] + (["[V]"] if volts else [])
    head += ["bits", "branches"]
    rows = []
    for number, one in enumerate(plan.suggestions, 1):
        row = [str(number), one.purpose, f"{one.A:.5f}", f"{one.Omega:.5f}", f"{one.f:.4f}", f"{1e3 * one.E:.4f}"]
        row += [f"{1e3 * one.E_cmd:.4f}"] + ([f"{one.volts:.4f}"] if volts else [])
        row += [f"{one.bits:.1f}" if one.bits else "", ", ".join(dict.fromkeys(one.branches))]
        rows.append(row)
    return head, rows
