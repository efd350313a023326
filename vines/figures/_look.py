"""What a declaration may change in the look of every figure: size, letters, colours, labels, limits, legend."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal, TypeVar

__all__ = ["Look", "WornColours", "wearing", "worn"]

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Look:
    """The look of one figure, over that which all figures share.

    Attributes
    ----------
    settings : mapping
        Settings of matplotlib, as a style sheet gives them.
    font_size : float, optional
        Of numbers and captions [point]; everything else that is written keeps its ratio to them.
    colours : mapping of str to str
        Colours, ``"#rrggbb"``, by the names of :data:`vines.figures.COLOUR_NAMES`.
    labels : mapping of str to str
        What is written at the axes that show a quantity or a parameter, by its name.
    limits : mapping of str to (float, float)
        The parts of these axes that are shown.
    legend : {"below", "above", "right", "none"}
        Where the legend of the figure stands.
    letters : bool, optional
        Whether panels are lettered; as each plot does it if left out.
    height : float, optional
        Height of the whole figure [inch]; as the panels need it if left out.
    """

    settings: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    font_size: float | None = None
    colours: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    labels: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    limits: Mapping[str, tuple[float, float]] = field(default_factory=lambda: MappingProxyType({}))
    legend: Literal["below", "above", "right", "none"] = "below"
    letters: bool | None = None
    height: float | None = None


_WORN: ContextVar[Look] = ContextVar("_WORN", default=Look())  # noqa: B039 - a Look is frozen


def worn() -> Look:
    """Return the look that figures have now."""
    return _WORN.get()


@contextmanager
def wearing(look: Look) -> Iterator[None]:
    """Draw with a look over ours."""
    token = _WORN.set(look)
    try:
        yield
    finally:
        _WORN.reset(token)


class WornColours(Mapping[str, Value]):
    """Colours by name, or groups of them; those of the look that is worn count first.

    Parameters
    ----------
    own : mapping
        Ours.
    follow : mapping of str to callable, optional
        How a colour follows from that of another name where that is worn: ``{"L light": ("L", lighten)}``.

    Examples
    --------
    >>> colours = WornColours({"L": "#c8102e"})
    >>> with wearing(Look(colours={"L": "#000000"})):
    ...     colours["L"]
    '#000000'
    >>> colours["L"]
    '#c8102e'
    """

    def __init__(self, own: Mapping[str, Value], follow: Mapping[str, tuple[str, Any]] | None = None) -> None:
        self._own = own
        self._follow = follow or {}

    def __getitem__(self, name: str) -> Value:
        colours: Mapping[str, Any] = worn().colours
        if name in colours:
            return colours[name]
        if name in self._follow and self._follow[name][0] in colours:
            source, how = self._follow[name]
            return how(colours[source])
        return self._own[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._own)

    def __len__(self) -> int:
        return len(self._own)


class WornPairs(Mapping[str, tuple[str, str]]):
    """Pairs of colours, of what is on L and on R; ``"<name> L"`` and ``"<name> R"`` of the look count first."""

    def __init__(self, own: Mapping[str, tuple[str, str]]) -> None:
        self._own = own

    def __getitem__(self, name: str) -> tuple[str, str]:
        left, right = self._own[name]
        colours = worn().colours
        return colours.get(f"{name} L", left), colours.get(f"{name} R", right)

    def __iter__(self) -> Iterator[str]:
        return iter(self._own)

    def __len__(self) -> int:
        return len(self._own)


class WornList(Sequence[str]):
    """Colours by number, from 0; ``"<name> 1"`` of the look is the first."""

    def __init__(self, name: str, own: Sequence[str]) -> None:
        self._name = name
        self._own = own

    def __getitem__(self, number: Any) -> Any:
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        return worn().colours.get(self.names[number], self._own[number])

    @property
    def names(self) -> list[str]:
        """What a look calls them."""
        return [f"{self._name} {k + 1}" for k in range(len(self._own))]

    def __len__(self) -> int:
        return len(self._own)
