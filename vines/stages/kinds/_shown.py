"""Kinds that show what others computed: figures, and checks of published values."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import msgspec

from vines.errors import FileMissingError
from vines.pipeline import Kind, register
from vines.places import shipped

__all__ = ["Cell", "CheckOptions", "FigureOptions", "register_shown"]


class Cell(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A panel of a figure with panels of several kinds: what it shows of which of the needed stages.

    Of runs it shows the two ends of the cavity with the ball (`ends`) or gap and relative velocity (`gap`) over
    `periods` forcing periods, or the phase plane of all of them. Of sweeps and branches that vary one parameter it
    shows a quantity, or the moduli of the multipliers of the branch that `families` names.

    `families` are the labels of branches, such as ``1:1 symmetric``, all by default. `marks` are the types of
    bifurcations that are marked, each with what is written beside it; all by default. `opacity` is that of simulated
    impacts, where they repeat they add up to solid. `window` and `y` are the parts of the axes that are shown.

    In a ``response`` it shows `energy` (K2/K1 and max|x1|), `max_abs_x1` alone, or `w_dot` of sweeps that are carried
    along one axis, of their points those that agree with `where`. What then differs beside the carried axis tells
    curves apart; they get `colours` in ascending order.
    """

    show: Literal["ends", "gap", "phase_plane", "multipliers", "w_dot", "dt", "x1", "phase", "energy", "max_abs_x1"]
    of: tuple[str, ...]
    title: str = ""
    periods: float = 3.0
    families: tuple[str, ...] = ()
    marks: dict[str, str] = {}
    opacity: float | None = None
    window: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    where: dict[str, float] = {}
    colours: tuple[Literal["red", "green", "blue", "black", "orange"], ...] = ("red", "green", "blue")


class FigureOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A picture of the needed stages; `panels` are the quantities shown, by default those of the plot.

    `window` is the part of the varied parameter that is shown; with `mirror` the mirror images of asymmetric orbits are
    drawn too. A sheet has `cells` of several kinds in `columns`, in rows of the `height` given in inches,
    with `letters` on each panel or each row. A response has `cells` of sweeps with all attractors that coexist, and a
    strip with the reduction of max|x1| below each that shows energies.

    Plots of a rig: `rig_branches` lays reconstructed runs on needed branches over the forcing amplitude (panels
    max_abs_x1, kinetic_ratio, w_dot, phase), `rig_residual` shows what fits leave over the temperature, `rig_cycles`
    and `rig_waits` show compared runs beside the model: w' over w, and the times between impacts.
    """

    plot: Literal[
        "bifurcation",
        "reduced",
        "multipliers",
        "chart",
        "basins",
        "sheet",
        "response",
        "regimes",
        "rig_branches",
        "rig_residual",
        "rig_cycles",
        "rig_waits",
    ]
    panels: tuple[str, ...] = ()
    title: str = ""
    width: float = 7.0
    window: tuple[float, float] | None = None
    mirror: bool = False
    cells: tuple[Cell, ...] = ()
    columns: int = 1
    letters: Literal["panels", "rows"] = "panels"
    height: float = 2.3


class CheckOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Published values against the tables of the needed stages."""

    claims: tuple[str, ...]


def _claims_file(options: Any, root: Path) -> tuple[Path, ...]:
    del options
    for file in (root / "pipelines" / "claims.toml", shipped("pipelines") / "claims.toml"):
        if file.is_file():
            return (file,)
    raise FileMissingError("pipelines/claims.toml, the published values, is missing; take it from the vines sources")


def register_shown() -> None:
    """Make figures and checks known to declarations."""
    register(
        Kind(
            name="figure",
            summary="a picture of other stages, PNG and SVG",
            shape="whole",
            options=FigureOptions,
            body="vines.stages.plots._figure:compute",
            needs=True,
            pictures=True,
        )
    )
    register(
        Kind(
            name="check",
            summary="published values against the tables of other stages",
            shape="whole",
            options=CheckOptions,
            body="vines.stages.bodies._check:compute",
            tables=("checks",),
            needs=True,
            files=_claims_file,
        )
    )
