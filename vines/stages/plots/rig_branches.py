"""The plot ``rig_branches``: reconstructed runs on branches of the model over the forcing amplitude."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from msgspec import Meta

from vines.errors import DeclarationError
from vines.figures import MEASURES, RIG_PANELS
from vines.model import VI_NES
from vines.stages.plots._checks import check_panels, check_window, needs_table
from vines.stages.plots._plot import Plot, PlotOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.figures import BranchLine, RigPoints
    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOT", "RigBranchesOptions", "impact_places"]

Row = dict[str, Any]


class RigBranchesOptions(PlotOptions, frozen=True, tag="rig_branches"):
    """Stages of kind `reconstruct` as points with error bars, branches over A as lines, a panel a quantity.

    With a stage of kind `compare` what the model gives at the measured parameters stands beside each run.
    """

    panels: Annotated[tuple[str, ...], Meta(min_length=1, description=f"Quantities shown: {', '.join(RIG_PANELS)}")] = (
        "max_abs_x1",
        "w_dot",
        "phase",
    )
    window: Annotated[
        tuple[float, float] | None, Meta(description="The part of the amplitudes that is shown; all runs if left out")
    ] = None


def _check(stage: Stage, pipeline: Pipeline) -> None:
    check_window(stage.options)
    needs_table(stage, pipeline, "reconstructions", "reconstruct")
    check_panels(stage.options, RIG_PANELS)
    for name in stage.needs:
        axes = [axis.name for axis in pipeline.stages[name].axes]
        if axes not in ([], ["A"]):
            raise DeclarationError(f"rig points lie over A; {name} varies {' and '.join(axes)}")


def _draw(inputs: Mapping[str, Input], options: RigBranchesOptions) -> Figure:
    from vines.figures import rig_branches_figure
    from vines.stages.plots._caption import listed, shared_params
    from vines.stages.plots._diagram import diagram_parts
    from vines.stages.plots._rig import reconstructed, tables_of

    branches = [stage for stage in inputs.values() if "orbits" in stage.tables]
    runs = reconstructed(inputs)
    impacts = [row for stage in tables_of(inputs, "reconstructions") for row in stage.table("rig_impacts").to_pylist()]
    model = {
        row["run_id"]: row
        for stage in tables_of(inputs, "comparisons")
        for row in stage.table().to_pylist()
        if row["basis"] == "measured" and row["rank"] == 0
    }
    lines = diagram_parts(branches, mirror=True)[1] if branches else []
    lines += [line for stage in branches for line in _measure_lines(stage)]
    points = {
        name: _whole_runs(runs, name, model) if name in MEASURES else _places(runs, impacts, name)
        for name in options.panels
    }
    return rig_branches_figure(
        points,
        lines,
        caption="; ".join(
            filter(None, (options.title, f"branches at {listed(shared_params(branches))}" if branches else ""))
        ),
        width=options.inches,
        window=options.window,
    )


def _measure_lines(stage: Input) -> Iterable[BranchLine]:
    """Yield a line for the quantities of whole orbits of each branch."""
    import numpy as np

    from vines.figures import BranchLine
    from vines.stages.plots._diagram import family_label, family_of

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
    import numpy as np

    from vines.figures import RigPoints
    from vines.stages.plots._rig import column

    told = [row for row in runs if row[name] is not None]
    beside = [model.get(row["run_id"], {}) for row in told]
    return RigPoints(
        **_where(told),
        y=column(told, name),
        u_y=column(told, f"u_{name}"),
        side=np.zeros(len(told), dtype=np.int64),
        model=column(beside, f"model_{name}"),
        u_model=column(beside, f"u_model_{name}"),
    )


def _places(runs: list[Row], impacts: list[Row], name: str) -> RigPoints:
    """Return a quantity of the impacts in each place of the pattern of each run; nothing where no pattern holds."""
    import numpy as np

    from vines.figures import RigPoints

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
    import numpy as np

    periods: dict[int, list[Row]] = {}
    for row in impacts:
        periods.setdefault(row["period"], []).append(row)
    sides = {number: VI_NES.letters(row["side"] for row in own) for number, own in periods.items()}
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
    import numpy as np

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
    import numpy as np

    from vines.stages.plots._rig import column

    return {
        "x": column(runs, "A"),
        "u_x": column(runs, "u_A"),
        "protocol": np.array([row["protocol"] for row in runs], dtype=str),
        "good": np.array([row["accepted"] and row["holds"] for row in runs], dtype=bool),
    }


PLOT = Plot(
    summary="reconstructed runs on branches of the model",
    options=RigBranchesOptions,
    draw=_draw,
    check=_check,
    tables=("reconstructions",),
)
