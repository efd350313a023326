"""Figures of a rig: from the tables of reconstructed and compared runs, and of branches, to what is drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.figures import (
    MEASURES,
    BranchLine,
    RigCycle,
    RigPoints,
    rig_branches_figure,
    rig_cycles_figure,
    rig_residual_figure,
    rig_waits_figure,
)
from vines.pipeline import Input
from vines.stages.plots._diagram import diagram_parts, family_label, family_of, listed, shared_params

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PLOTS", "impact_places", "rig_branches", "rig_cycles", "rig_residual", "rig_waits"]

Row = dict[str, Any]


def rig_branches(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw what was measured over the amplitude on the branches of the model."""
    branches = [stage for stage in inputs.values() if "orbits" in stage.tables]
    runs = _reconstructed(inputs)
    impacts = [row for stage in _of(inputs, "reconstructions") for row in stage.table("rig_impacts").to_pylist()]
    model = {
        row["run_id"]: row
        for stage in _of(inputs, "comparisons")
        for row in stage.table().to_pylist()
        if row["basis"] == "measured" and row["rank"] == 0
    }
    lines = diagram_parts(branches, mirror=True)[1] if branches else []
    lines += [line for stage in branches for line in _measure_lines(stage)]
    chosen = options.panels or ("max_abs_x1", "w_dot", "phase")
    points = {
        name: _whole_runs(runs, name, model) if name in MEASURES else _places(runs, impacts, name) for name in chosen
    }
    return rig_branches_figure(
        points,
        lines,
        caption="; ".join(
            filter(None, (options.title, f"branches at {listed(shared_params(branches))}" if branches else ""))
        ),
        width=options.width,
        window=options.window,
    )


def _of(inputs: Mapping[str, Input], table: str) -> list[Input]:
    return [stage for stage in inputs.values() if table in stage.tables]


def _reconstructed(inputs: Mapping[str, Input]) -> list[Row]:
    """Return the rows of all runs that could be reconstructed."""
    rows = [row for stage in _of(inputs, "reconstructions") for row in stage.table().to_pylist()]
    return [row for row in rows if row["status"] == "ok"]


def _measure_lines(stage: Input) -> Iterable[BranchLine]:
    """Yield a line for the quantities of whole orbits of each branch."""
    orbits = stage.table("orbits").to_pylist()
    for branch in stage.table("branches").to_pylist():
        mine = [row for row in orbits if row["branch_id"] == branch["branch_id"]]
        yield BranchLine(
            x=np.array([row["A"] for row in mine]),
            side=0,
            stable=np.array([row["stable"] for row in mine], dtype=bool),
            values={name: np.array([row[name] for row in mine]) for name in MEASURES},
            label=family_label(branch),
            family=family_of(branch),
        )


def _whole_runs(runs: list[Row], name: str, model: Mapping[str, Row]) -> RigPoints:
    told = [row for row in runs if row[name] is not None]
    beside = [model.get(row["run_id"], {}) for row in told]
    return RigPoints(
        **_where(told),
        y=_column(told, name),
        u_y=_column(told, f"u_{name}"),
        side=np.zeros(len(told), dtype=np.int64),
        model=_column(beside, f"model_{name}"),
        u_model=_column(beside, f"u_model_{name}"),
    )


def _places(runs: list[Row], impacts: list[Row], name: str) -> RigPoints:
    """Return a quantity of the impacts in each place of the pattern of each run; nothing where no pattern holds."""
    told: list[Row] = []
    found: list[tuple[float, float, int]] = []
    for run in runs:
        if run["holds"]:
            own = [row for row in impacts if row["run_id"] == run["run_id"]]
            for place in impact_places(own, str(run["word"]).split()):
                found.append(_mean(place, run, name))
                told.append(run)
    y, u_y, side = (np.array(column) for column in zip(*found, strict=True)) if found else (np.zeros(0),) * 3
    lack = np.full(len(told), math.nan)
    return RigPoints(**_where(told), y=y, u_y=u_y, side=side.astype(np.int64), model=lack, u_model=lack)


def impact_places(impacts: list[Row], word: list[str]) -> list[list[Row]]:
    """Return the impacts in each place of a pattern.

    Parameters
    ----------
    impacts : list of dict
        Rows of ``rig_impacts`` of one run.
    word : list of str
        Sides in each of the p periods of the pattern.

    Examples
    --------
    >>> train = [{"period": k // 2, "side": 1 - 2 * (k % 2)} for k in range(8)]
    >>> [[row["side"] for row in place] for place in impact_places(train, ["LR"])]
    [[1, 1, 1, 1], [-1, -1, -1, -1]]
    """
    periods: dict[int, list[Row]] = {}
    for row in impacts:
        periods.setdefault(row["period"], []).append(row)
    sides = {number: "".join("L" if row["side"] > 0 else "R" for row in own) for number, own in periods.items()}
    p = len(word)
    # A repetition may begin in any period: take the turn in which most of them fit.
    turn = max(range(p), key=lambda t: sum(text == word[(number + t) % p] for number, text in sides.items()))
    places: list[list[Row]] = [[] for letters in word for _ in letters]
    first = np.cumsum([0, *(len(letters) for letters in word)])
    for number, text in sides.items():
        at = (number + turn) % p
        if text == word[at]:
            for k, row in enumerate(periods[number]):
                places[int(first[at]) + k].append(row)
    return places


def _mean(place: list[Row], run: Row, name: str) -> tuple[float, float, int]:
    """Return mean, standard uncertainty and side of a quantity of the impacts in one place."""
    side = int(place[0]["side"])
    count = len(place)
    if name == "phase":
        turns = np.exp(1j * np.array([row["phase"] for row in place]))
        middle = float(np.angle(turns.mean()))
        away = np.angle(turns * np.exp(-1j * middle))
        u = math.hypot(float(away.std()) / math.sqrt(count), run["u_impact_phase"] or 0.0)
        return middle % (2 * math.pi), u, side
    unit = run["b"] * run["omega0"]
    values = np.array([row["w_dot"] for row in place if row["w_dot"] is not None]) / unit
    mean = float(values.mean())
    return mean, math.hypot(float(values.std()) / math.sqrt(len(values)), mean * run["u_b"] / run["b"]), side


def _where(runs: list[Row]) -> dict[str, Any]:
    return {
        "x": _column(runs, "A"),
        "u_x": _column(runs, "u_A"),
        "protocol": np.array([row["protocol"] for row in runs], dtype=str),
        "good": np.array([row["accepted"] and row["holds"] for row in runs], dtype=bool),
    }


def _column(rows: list[Row], name: str) -> np.ndarray:
    return np.array([math.nan if row.get(name) is None else row[name] for row in rows], dtype=float)


def rig_residual(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw the residual of each run over its temperature."""
    runs = _reconstructed(inputs)
    return rig_residual_figure(
        _column(runs, "temperature"),
        _column(runs, "residual"),
        _column(runs, "noise"),
        [row["protocol"] for row in runs],
        np.array([row["accepted"] for row in runs], dtype=bool),
        caption=options.title,
        width=options.width,
    )


def _cycles(inputs: Mapping[str, Input]) -> list[RigCycle]:
    """Return the nearest branch beside each run at measured parameters, in the order of the runs' names."""
    found: list[RigCycle] = []
    for stage in _of(inputs, "rig_cycles"):
        told = {row["point_id"]: row for row in stage.table("comparisons").to_pylist()}
        for row in stage.table("rig_cycles").to_pylist():
            if row["rank"] or row["basis"] != "measured":
                continue
            about = told[row["point_id"]]
            columns = {name: np.array(row[name]) for name in ("w", "w_dot", "model_w", "model_w_dot")}
            found.append(
                RigCycle(
                    title=f"{row['run_id']}: {row['branch']}, {about['verdict'].replace('_', ' ')}",
                    edges=np.array(row["wait_edges"]),
                    share=np.array(row["wait_share"]),
                    model_share=np.array(row["model_wait_share"]),
                    rms=(about["rms_w"] or math.nan, about["rms_w_dot"] or math.nan),
                    **columns,
                )
            )
    return sorted(found, key=lambda cycle: cycle.title)


def rig_cycles(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw w' over w of runs and model."""
    return rig_cycles_figure(_cycles(inputs), caption=options.title, width=options.width)


def rig_waits(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw the times between impacts of runs and model."""
    return rig_waits_figure(_cycles(inputs), caption=options.title, width=options.width)


PLOTS: dict[str, Callable[[Mapping[str, Input], Any], Figure]] = {
    "rig_branches": rig_branches,
    "rig_cycles": rig_cycles,
    "rig_residual": rig_residual,
    "rig_waits": rig_waits,
}
"""What draws each plot of a rig."""
