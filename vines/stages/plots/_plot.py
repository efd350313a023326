"""What a plot is, and which plots there are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import msgspec

from vines.doors import Register
from vines.errors import DeclarationError
from vines.model import VI_NES, system_names
from vines.schema import system_table, tables
from vines.stages.plots._look import LookOptions
from vines.stages.plots._width import inches

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vines.pipeline import Input, Pipeline, Stage

__all__ = ["PLOTS", "Plot", "PlotOptions", "plot_of", "register"]


class PlotOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="plot"):
    """A picture of the needed stages; which further options there are depends on the plot."""

    title: Annotated[str, msgspec.Meta(description="Written above; the parameters that all stages share if empty")] = ""
    width: Annotated[
        Annotated[float, msgspec.Meta(gt=0)] | str,
        msgspec.Meta(description='Width of the picture: inches, or a text with its unit, "85mm", "8.5cm", "3.35in"'),
    ] = 7.0
    look: Annotated[
        LookOptions | msgspec.UnsetType,
        msgspec.Meta(description="Size, letters, colours, labels, limits and files of the picture"),
    ] = msgspec.UNSET  # so that it stands in no key where nothing is said

    @property
    def worn(self) -> LookOptions:
        """The look that is declared, or that of all figures."""
        return LookOptions() if self.look is msgspec.UNSET else self.look

    @property
    def inches(self) -> float:
        """Width of the picture [inch].

        Raises
        ------
        DeclarationError
            If it is no width of a picture.
        """
        return inches(self.width)


@dataclass(frozen=True, slots=True)
class Plot:
    """A way to draw stages: everything that is known of it.

    The module of `draw` imports numpy, pyarrow and vines.figures inside functions only: declarations are checked, and
    lists made, without them.

    Attributes
    ----------
    summary : str
        One line for lists.
    options : type of PlotOptions
        The keys that a figure of this plot may have. Its tag is the name of the plot: what a declaration writes after
        ``plot =``.
    draw : callable
        ``draw(inputs, options)`` makes the picture of the needed stages, in the order declared. It is a function of a
        module; what that imports counts in the key of the figure.
    check : callable, optional
        ``check(stage, pipeline)`` raises :class:`vines.errors.DeclarationError` if the needed stages, ``stage.needs``,
        cannot be drawn so; called when the declaration is read.
    tables : tuple of str, optional
        Tables, as the VI-NES calls them, without which it draws nothing of a system. A system that has none such is
        refused when the declaration is read; if empty, the plot itself sees to systems.

    Examples
    --------
    >>> PLOTS.get("chart").name
    'chart'
    """

    summary: str
    options: type[PlotOptions]
    draw: Callable[[Mapping[str, Input], Any], Figure]
    check: Callable[[Stage, Pipeline], None] | None = None
    tables: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """What a declaration writes after ``plot =``."""
        return str(self.options.__struct_config__.tag)

    def draws(self, system: str) -> bool:
        """Say whether a system has what the plot draws.

        Examples
        --------
        >>> [PLOTS.get(name).draws("parallel") for name in ("bifurcation", "reduced")]
        [True, False]
        """
        return system == VI_NES.name or all(system_table(system, each) in tables() for each in self.tables)

    def check_systems(self, stage: Stage, pipeline: Pipeline) -> None:
        """Refuse needed stages of systems that the plot cannot draw.

        Raises
        ------
        DeclarationError
            With the systems that it can draw, and the plots that can draw the system.
        """
        for name in stage.needs:
            system = pipeline.stages[name].kind.system
            if not self.draws(system):
                can = ", ".join(each for each in sorted(system_names()) if self.draws(each))
                others = ", ".join(sorted(each for each, plot in PLOTS.all().items() if plot.draws(system)))
                raise DeclarationError(
                    f"the plot {self.name!r} cannot draw the system {system!r} of {name}; it can draw {can}; "
                    f"plots that can draw {system!r}: {others}"
                )


PLOTS: Register[Plot] = Register("plot", "vines.plots", Plot, DeclarationError)
"""The plots that are known. Another package brings one by an entry point of the group ``vines.plots``."""

PLOTS.add_modules("vines.stages.plots", "PLOT")


def register(new: Plot) -> Plot:
    """Make a plot known to declarations and return it. The last registration of a name counts."""
    return PLOTS.add(new)


def plot_of(options: msgspec.Struct) -> Plot:
    """Return the plot that options belong to."""
    return PLOTS.get(str(options.__struct_config__.tag))
