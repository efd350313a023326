"""Declared pipelines: what a TOML file says, as typed and checked data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import DeclarationError, UnknownNameError, nearest

if TYPE_CHECKING:
    import msgspec

    from vines.model import Expression
    from vines.pipeline._axes import Axis
    from vines.pipeline._kinds import Kind

__all__ = ["JUMP", "MOST", "Carry", "Pipeline", "Refine", "Stage"]

JUMP = (("", 0.1),)
"""Relative change of a number from one point to the next that counts as a jump, where nothing is said."""
MOST = 10_000
"""Points that a refinement adds at most, where nothing is said."""


@dataclass(frozen=True, slots=True)
class Carry:
    """How the end state of a point becomes the start of the next.

    Attributes
    ----------
    axis : str
        The carried axis.
    direction : {"up", "down"}
        Whether the chain runs along rising or falling values.
    stage : str or None
        Another stage, one point of which gives the start of the first point.
    at : dict of str to float
        The varied values of that point.
    """

    axis: str
    direction: Literal["up", "down"] = "up"
    stage: str | None = None
    at: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Refine:
    """Where points are added to a grid.

    Attributes
    ----------
    on : tuple of str
        Columns of the primary table that are watched.
    along : str
        The axis between whose neighbours points are added.
    tolerance : float
        Neighbours nearer than this get no point between them.
    jump : tuple of (str, float)
        The relative change of each watched number beyond which a point is added; ``""`` stands for all others.
    most : int
        More points than this are not added.
    """

    on: tuple[str, ...]
    along: str
    tolerance: float
    jump: tuple[tuple[str, float], ...] = JUMP
    most: int = MOST

    def jump_of(self, name: str) -> float:
        """Return the relative change of a column that counts as a jump."""
        table = dict(self.jump)
        return table.get(name, table[""])

    def canonical(self) -> dict[str, Any]:
        """Return the declaration as plain data."""
        return {
            "on": sorted(self.on),
            "along": self.along,
            "tolerance": self.tolerance,
            "jump": dict(self.jump),
            "most": self.most,
        }


@dataclass(frozen=True, slots=True)
class Stage:
    """One stage of a pipeline.

    Attributes
    ----------
    name : str
        Its name.
    kind : Kind
        What it does.
    options : msgspec.Struct
        The options of the kind, defaults filled in.
    params : dict of str to float
        The fixed parameters, defaults filled in; those that vary are left out.
    axes : tuple of Axis
        The varied parameters, in the order declared.
    carry : Carry or None
        Whether and how states are carried along an axis.
    needs : tuple of str
        Stages whose results it takes, in the order declared.
    zipped : tuple of tuple of str
        Axes that run together.
    refine : Refine or None
        Where points are added to the grid.
    links : dict of str to Expression
        Parameters that follow from varied ones, each after those that it needs itself.
    """

    name: str
    kind: Kind
    options: msgspec.Struct
    params: dict[str, float]
    axes: tuple[Axis, ...]
    carry: Carry | None
    needs: tuple[str, ...]
    zipped: tuple[tuple[str, ...], ...] = ()
    refine: Refine | None = None
    links: dict[str, Expression] = field(default_factory=dict)

    @property
    def after(self) -> tuple[str, ...]:
        """The stages that must be done before this one: its needs, and where its start comes from."""
        start = (self.carry.stage,) if self.carry is not None and self.carry.stage else ()
        return (*self.needs, *start)


@dataclass(frozen=True)
class Pipeline:
    """A declared pipeline.

    Attributes
    ----------
    name, title, source : str
        Its name, what it is, and which figure or section it reproduces.
    path : Path
        The file that declares it.
    root : Path
        The root of the project that it was loaded for.
    stages : dict of str to Stage
        In the order declared.
    """

    name: str
    title: str
    source: str
    path: Path
    root: Path
    stages: dict[str, Stage]

    @cached_property
    def order(self) -> tuple[str, ...]:
        """Names of the stages, each after those that it needs.

        Raises
        ------
        DeclarationError
            If a stage needs itself, directly or through others.
        """
        sorter: TopologicalSorter[str] = TopologicalSorter()
        for stage in self.stages.values():
            sorter.add(stage.name, *stage.after)
        try:
            return tuple(sorter.static_order())
        except CycleError as error:
            circle = " needs ".join(reversed(error.args[1]))
            text = f"{self.path}: {circle}: a stage cannot need itself; remove one of these needs"
            raise DeclarationError(text) from None

    def select(self, names: Iterable[str] | None) -> tuple[str, ...]:
        """Return the named stages and all that they need, in the order to run them; all if `names` is None.

        Raises
        ------
        UnknownNameError
            If there is no such stage.
        """
        if names is None:
            return self.order
        wanted: set[str] = set()
        open_ends = list(names)
        while open_ends:
            name = open_ends.pop()
            if name not in self.stages:
                known = nearest(name, self.stages)
                raise UnknownNameError(f"pipeline {self.name!r} has no stage {name!r}: {known}")
            if name not in wanted:
                wanted.add(name)
                open_ends.extend(self.stages[name].after)
        return tuple(name for name in self.order if name in wanted)
