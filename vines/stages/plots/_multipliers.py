"""From branches to the moduli of their multipliers as a figure shows them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow.compute as pc

from vines.errors import DeclarationError, nearest
from vines.figures import MultiplierLines, multiplier_figure
from vines.pipeline import Input
from vines.stages.plots._diagram import family_label, family_of, listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["multiplier_lines", "multipliers"]


def multipliers(inputs: Mapping[str, Input], options: Any) -> Figure:
    """Draw a panel for each branch, or for each that `panels` names by its label, such as ``1:1 symmetric``.

    Raises
    ------
    DeclarationError
        If there is no branch of that label.
    """
    stages = [stage for stage in inputs.values() if "branches" in stage.tables]
    return multiplier_figure(
        stages[0].axes[0],
        multiplier_lines(stages, options.panels),
        caption=options.title or listed(stages[0].params),
        width=options.width,
        window=options.window,
    )


def multiplier_lines(stages: Iterable[Input], labels: Sequence[str]) -> list[MultiplierLines]:
    """Return the branches of these labels, or all; the first where several have the same.

    Raises
    ------
    DeclarationError
        If there is no branch of a label.
    """
    found = [branch for stage in stages for branch in _branches(stage)]
    known = list(dict.fromkeys(branch.label for branch in found))
    for label in labels:
        if label not in known:
            raise DeclarationError(f"no branch {label!r} to show multipliers of: {nearest(label, known)}")
    return [next(b for b in found if b.label == label) for label in labels] or found


def _branches(stage: Input) -> list[MultiplierLines]:
    axis = stage.axes[0]
    orbits, bifurcations = stage.table("orbits"), stage.table("bifurcations")
    lines = []
    for branch in stage.table("branches").to_pylist():
        mine = orbits.filter(pc.field("branch_id") == branch["branch_id"])
        met = bifurcations.filter(pc.field("branch_id") == branch["branch_id"])
        real, imaginary = (np.array(mine[f"multipliers_{part}"].to_pylist()) for part in ("re", "im"))
        lines.append(
            MultiplierLines(
                x=mine[axis].to_numpy(),
                moduli=-np.sort(-np.hypot(real, imaginary), axis=1),
                marks=tuple(zip(met["type"].to_pylist(), met["value"].to_pylist(), strict=True)),
                label=family_label(branch),
                family=family_of(branch),
            )
        )
    return lines
