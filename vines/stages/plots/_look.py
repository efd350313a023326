"""The look of one figure, as a declaration has it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vines.errors import DeclarationError, nearest
from vines.figures import COLOUR_NAMES, NAMES, PANELS, QUANTITIES, SHOWN
from vines.schema import table, tables
from vines.stages.plots._width import inches

__all__ = ["LookOptions", "check_look", "worn_by"]

_COLOUR = re.compile(r"#[0-9a-fA-F]{6}")


class LookOptions(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Size, letters, colours, labels, limits and files of one figure, over the look that all share."""

    height: Annotated[
        Annotated[float, Meta(gt=0)] | str | None,
        Meta(description="Height of the whole picture, as `width`; what the panels need if left out"),
    ] = None
    dpi: Annotated[int, Meta(ge=30, le=2400, description="Pixels per inch of the PNG, and of dense dots")] = 200
    formats: Annotated[
        tuple[Literal["png", "svg", "pdf"], ...],
        Meta(min_length=1, description="Files that are written"),
    ] = ("png", "svg", "pdf")
    font_size: Annotated[
        Annotated[float, Meta(ge=4, le=24)] | None,
        Meta(description="Size of numbers and captions [point], 8.5 if left out; other text in ratio"),
    ] = None
    labels: Annotated[
        dict[str, str], Meta(description="What is written at axes, by the parameter or quantity that they show")
    ] = msgspec.field(default_factory=dict)
    limits: Annotated[
        dict[str, tuple[float, float]],
        Meta(description="The part of axes that is shown, by the parameter or quantity that they show"),
    ] = msgspec.field(default_factory=dict)
    colours: Annotated[
        dict[str, str],
        Meta(description='Colours, "#rrggbb", by name: L, R, "asymmetric L", "ball 1", fold, chaotic, red, ...'),
    ] = msgspec.field(default_factory=dict)
    legend: Annotated[
        Literal["below", "above", "right", "none"], Meta(description="Where the legend of the figure stands")
    ] = "below"
    letters: Annotated[
        bool | None, Meta(description="Whether panels are lettered; as the plot does it if left out")
    ] = None


def check_look(look: LookOptions) -> None:
    """Refuse heights, names and colours that mean nothing.

    Raises
    ------
    DeclarationError
        With what is allowed.
    """
    if look.height is not None:
        inches(look.height, "look.height")
    if len(set(look.formats)) < len(look.formats):
        raise DeclarationError(f"look.formats = {list(look.formats)} names a format twice")
    if look.labels or look.limits:  # else nothing is loaded for them
        known = _known()
        for what, names in (("labels", look.labels), ("limits", look.limits)):
            for name in names:
                if name not in known:
                    raise DeclarationError(f"look.{what}: {name!r} is no parameter or quantity: {nearest(name, known)}")
    for name, (low, high) in look.limits.items():
        if not low < high:
            raise DeclarationError(f"look.limits.{name}: {low:g} to {high:g}; give the lower end first")
    for name, colour in look.colours.items():
        if name not in COLOUR_NAMES:
            raise DeclarationError(f"look.colours: no colour {name!r}: {nearest(name, COLOUR_NAMES)}")
        if not _COLOUR.fullmatch(colour):
            raise DeclarationError(f'look.colours.{name} is {colour!r}; allowed is "#rrggbb", such as "#0b4ea2"')


def _known() -> list[str]:
    """Return what axes can show."""
    columns = {column.name for name in tables() for column in table(name).columns}
    return sorted({*NAMES, *PANELS, *QUANTITIES, *SHOWN, *columns})


def worn_by(look: LookOptions, settings: Mapping[str, Any] | None = None) -> AbstractContextManager[None]:
    """Return the context in which a figure is drawn with a look, and with settings of matplotlib over ours."""
    from vines.figures import Look, wearing

    return wearing(
        Look(
            settings=settings or {},
            font_size=look.font_size,
            colours={name: colour.lower() for name, colour in look.colours.items()},
            labels=look.labels,
            limits=look.limits,
            legend=look.legend,
            letters=look.letters,
            height=None if look.height is None else inches(look.height, "look.height"),
        )
    )
