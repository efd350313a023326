"""Impacts and orbits of stages over one parameter as the dots, lines and markers of a diagram."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vines.figures import BranchLine, ImpactDots, Marker
from vines.model import Word, with_all_balls
from vines.schema import table
from vines.stages.plots._caption import listed, shared_params
from vines.stages.plots._checks import called

if TYPE_CHECKING:
    from vines.pipeline import Input

__all__ = ["diagram_parts", "family_label", "family_of"]

EVENT = "pair_turns_real"


def diagram_parts(
    stages: Sequence[Input], *, mirror: bool, families: Collection[str] = (), marks: Collection[str] = ()
) -> tuple[list[ImpactDots], list[BranchLine], list[Marker]]:
    """Return what a diagram of stages that vary one parameter draws.

    Parameters
    ----------
    stages : sequence of Input
        Those with impacts give dots, those with orbits lines and markers.
    mirror : bool
        Whether mirror images of asymmetric orbits are drawn too.
    families : collection of str
        Labels of the branches that are drawn, see :func:`family_label`; all if empty.
    marks : collection of str
        Types of bifurcations that are marked; all if empty.
    """
    axis, shared = stages[0].axes[0], shared_params(stages)
    branches = [stage for stage in stages if called(stage.tables, "orbits")]
    mirror = mirror and all(map(_mirrored, branches))
    # Events, which are no bifurcations, are marked only where they do not crowd.
    events = len(branches) == 1
    chosen = [(stage, _chosen(stage, families)) for stage in branches]
    return (
        [_dots(stage, axis, shared) for stage in stages if called(stage.tables, "impacts")],
        [line for stage, rows in chosen for line in _lines(stage, rows, axis, shared, mirror)],
        [mark for stage, rows in chosen for mark in _markers(stage, rows, axis, marks, events=events, mirror=mirror)],
    )


def _mirrored(stage: Input) -> bool:
    """Return whether the mirror image of a motion is one, which a tilt ends."""
    own = table(called(stage.tables, "orbits")).system
    broken_by = with_all_balls(own).mirror.broken_by
    return all(stage.params.get(name, 0.0) == 0 and name not in stage.axes for name in broken_by)


def _chosen(stage: Input, families: Collection[str]) -> list[dict[str, Any]]:
    """Return the rows of the branches that are drawn."""
    rows = stage.table(called(stage.tables, "branches")).to_pylist()
    return [row for row in rows if not families or family_label(row) in families]


def _dots(stage: Input, axis: str, shared: dict[str, float]) -> ImpactDots:
    impacts = stage.table(called(stage.tables, "impacts"))
    column = _numpy(impacts)
    return ImpactDots(
        x=column(axis),
        side=column("side"),
        values={
            "w_dot": column("w_dot"),
            "dt": column("dt_next") * _frequency(impacts) / (2 * math.pi),
            "phase": column("phase"),
            **_displacement(impacts, column),
        },
        label=_label("simulation", stage, shared),
        repeats=_repeats(impacts),
        ball=_numbers(column("ball")) if "ball" in impacts.column_names else None,
    )


def _numbers(balls: np.ndarray) -> np.ndarray | None:
    """Return the numbers of the balls that hit, or None where balls have no numbers."""
    return balls if balls.any() else None


def _repeats(impacts: pa.Table) -> np.ndarray:
    """Return how often each impact came back while its point was observed: of a periodic one a repetition is kept."""
    if not impacts.num_rows:
        return np.ones(0)
    point = impacts["point_id"].combine_chunks().dictionary_encode().indices.to_numpy()
    flight = _numpy(impacts)("dt_next") * _frequency(impacts)
    kept = np.bincount(point, weights=flight)
    return (kept.max() / kept)[point]


def _lines(
    stage: Input, branches: Iterable[dict[str, Any]], axis: str, shared: dict[str, float], mirror: bool
) -> Iterable[BranchLine]:
    """Yield a line for each impact of the orbits of each branch, and of their mirror images if these have one word."""
    orbits = stage.table(called(stage.tables, "orbits"))
    for branch in branches:
        mine = orbits.filter(pc.field("branch_id") == branch["branch_id"])
        x = _numpy(mine)(axis)
        stable = mine["stable"].to_numpy(zero_copy_only=False).astype(bool)
        values, sides = _per_impact(mine)
        word = Word(branch["word"])
        balls = word.balls
        # Of orbits without impacts what stands in their place is the passage through phase 0.
        family = family_label(branch) + (", at phase 0" if word.unstruck else "")
        both = mirror and _has_image(branch)
        for turned, shown in ((1, values), (-1, _image(values))) if both else ((1, values),):
            for k, side in enumerate(sides):
                yield BranchLine(
                    x=x,
                    side=turned * int(side),
                    stable=stable,
                    values={q: v[:, k] for q, v in shown.items()},
                    label=_label(family, stage, shared),
                    family=family_of(branch),
                    image=turned < 0,
                    ball=balls[k],
                    stop=int(side) == 0 and not word.unstruck,
                )


def family_label(branch: Mapping[str, Any]) -> str:
    """Return what a figure calls a branch, from its row.

    Examples
    --------
    >>> family_label({"word": "LR", "name": "1:1", "symmetric": True})
    '1:1 symmetric'
    >>> family_label({"word": "LLR", "name": "2:1", "symmetric": False})
    '2:1'
    >>> family_label({"word": "L*R*", "name": "1:1", "symmetric": True})
    '1:1 symmetric, L*R*'
    """
    word = Word(branch["word"])
    which = f" {'symmetric' if branch['symmetric'] else 'asymmetric'}" if word.symmetric else ""
    # Orbits that stick have the name of those that do not.
    return f"{branch['name']}{which}{f', {word}' if word.sticking else ''}"


def family_of(branch: Mapping[str, Any]) -> str:
    """Return the family of a branch for its colours, from its row.

    Examples
    --------
    >>> [family_of({"word": word, "symmetric": False}) for word in ("LR", "LRLR/2T", "LRLRLRLR/4T", "LLR")]
    ['asymmetric', 'doubled', 'doubled again', 'unequal']
    """
    word = Word(branch["word"])
    if word.n != word.m:
        return "unequal"
    if word.p == 1:
        return "symmetric" if branch["symmetric"] else "asymmetric"
    return "doubled" if word.p == 2 else "doubled again"


def _markers(
    stage: Input, branches: Iterable[dict[str, Any]], axis: str, marks: Collection[str], *, events: bool, mirror: bool
) -> Iterable[Marker]:
    """Yield the bifurcations on some branches."""
    drawn = {branch["branch_id"]: _has_image(branch) for branch in branches}
    for row in stage.table(called(stage.tables, "bifurcations")).to_pylist():
        if row["branch_id"] not in drawn or (row["type"] == EVENT and not events):
            continue
        if marks and row["type"] not in marks:
            continue
        period = 2 * math.pi / row.get("Omega", 1.0)
        t = np.array(row["t"])
        values = {name: np.array(row[name]) for name in ("w_dot", "phase", "x1") if name in row}
        values["dt"] = np.diff(t, append=t[0] + Word(row["word"]).p * period) / period
        if mirror and drawn[row["branch_id"]]:
            values = {name: np.append(value, _image(values)[name]) for name, value in values.items()}
        yield Marker(type=row["type"], x=row[axis], values=values)


def _has_image(branch: Mapping[str, Any]) -> bool:
    """Return whether the mirror images of a branch's orbits are other orbits of the same word."""
    word = Word(branch["word"])
    return not branch["symmetric"] and word.mirror == word


def _image(values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the quantities of the mirror images (x, t) -> (-x, t + half a forcing period)."""
    turned = {
        "w_dot": -values["w_dot"],
        "dt": values["dt"],
        "phase": (values["phase"] + math.pi) % (2 * math.pi),
    }
    return turned | ({"x1": -values["x1"]} if "x1" in values else {})


def _per_impact(orbits: pa.Table) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return the quantities of each impact as (orbits, impacts) arrays, and the side of each impact."""
    period = 2 * math.pi / _frequency(orbits)
    t = _matrix(orbits, "t")
    span = orbits["p"].to_numpy() * period
    dt = np.diff(t, axis=1, append=(t[:, 0] + span)[:, None]) / period[:, None]
    values = {name: _matrix(orbits, name) for name in ("w_dot", "x1", "phase") if name in orbits.column_names}
    values |= {"dt": dt}
    starts = Word(orbits["word"][0].as_py()).rotations()
    return _threaded(values, starts), _matrix(orbits, "side")[0]


def _threaded(values: dict[str, np.ndarray], starts: tuple[int, ...]) -> dict[str, np.ndarray]:
    """Let a column follow one impact along the branch.

    An orbit whose letters are a repetition has several first impacts, and which one is stored may change along the
    branch; of them the one is taken that is nearest to the orbit before.
    """
    if len(starts) == 1:
        return values
    known = np.stack([values["w_dot"], values["dt"]])
    shifts = np.zeros(known.shape[1], dtype=int)
    for i in range(1, known.shape[1]):
        before = np.roll(known[:, i - 1], -shifts[i - 1], axis=1)
        distances = [np.abs(np.roll(known[:, i], -start, axis=1) - before).max() for start in starts]
        shifts[i] = starts[int(np.argmin(distances))]
    places = (np.arange(known.shape[2]) + shifts[:, None]) % known.shape[2]
    return {name: np.take_along_axis(matrix, places, axis=1) for name, matrix in values.items()}


def _frequency(table: pa.Table) -> np.ndarray:
    """Return the frequency of the forcing, 1 for a system whose time is the phase."""
    return table["Omega"].to_numpy() if "Omega" in table.column_names else np.ones(table.num_rows)


def _displacement(table: pa.Table, column: Any) -> dict[str, np.ndarray]:
    """Return the displacement at impacts, for a system that has one."""
    return {"x1": column("x1")} if "x1" in table.column_names else {}


def _matrix(orbits: pa.Table, name: str) -> np.ndarray:
    return np.array(orbits[name].to_pylist())


def _numpy(table: pa.Table) -> Any:
    return lambda name: table[name].to_numpy()


def _label(what: str, stage: Input, shared: dict[str, float]) -> str:
    own = {name: value for name, value in stage.params.items() if name not in shared}
    return f"{what}, {listed(own)}" if own else what
