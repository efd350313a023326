"""Kinds of stages: light specifications and their register."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vines.doors import Register
from vines.errors import DeclarationError, UnknownNameError, VinesError, nearest
from vines.model import VI_NES, system_names

if TYPE_CHECKING:
    import msgspec

__all__ = ["KINDS", "Kind", "kind", "kinds", "register"]


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of stage: everything that is known of it without importing its body.

    Attributes
    ----------
    name : str
        What a declaration writes after ``kind =``.
    summary : str
        One line for lists.
    shape : {"points", "whole"}
        ``points``: a body ``compute(job: Job) -> Batch`` that gets some of the points of a grid at a time;
        each point is computed once and kept. ``whole``: a body ``compute(job: WholeJob) -> Batch`` that gets
        everything at once.
    options : type of msgspec.Struct
        The keys that a stage of this kind may have beside the general ones (``kind, params, vary, carry,
        needs``), with their types and defaults. The class must be importable by name, for worker processes.
    body : str
        ``"package.module:function"``, imported only when there is something to compute.
    tables : tuple of str
        The tables of ``schemas/`` that it makes; the first is the primary one. With the points shape it needs
        the columns ``status`` and ``reason``, and for a carried axis what the next point needs as its start.
    parameters : mapping of str to (float or None)
        The parameters that it takes, with defaults; ``None`` means that it must be given.
    vary : {"grid", "range", "none"}
        Whether ``vary.X`` declares values, a range, or is not allowed.
    carry : bool
        Whether ``carry`` is allowed.
    needs : bool
        Whether ``needs`` is allowed (whole shape only).
    logs, pictures : bool
        Whether it makes MCAP logs, or ``picture.png``, ``picture.svg`` and ``picture.pdf``.
    check : callable, optional
        ``check(params, options)`` raises :class:`vines.errors.ParameterError` (or `StateError`) when these
        cannot be. Called with the corners of the declared box before anything is written.
    files : callable, optional
        ``files(options, root)`` returns the files whose contents belong to the key, such as published claims.
    fits : callable, optional
        ``fits(stage, pipeline)``, a `Stage` and the `Pipeline` that it is in, raises
        :class:`vines.errors.DeclarationError` when the stage cannot be together with those that it needs. Called when
        everything else of a declaration is right.
    variants : Register, optional
        Of a kind whose options depend on what one key names, such as the plot of a figure, the things that it may
        name, each with `options` that are a subclass of the `options` here. The key is the tag field of both.
    code : callable, optional
        ``code(options)`` returns what the body calls beside its imports, as `body`, so that its code counts too.
    again : {"", "points", "long_points", "starts"}
        What of it ``vines verify --recompute`` can compute again from a row alone: a point in seconds, a point that
        takes longer, of which one of each result is drawn, or a start.
    scaled : tuple of str
        Parameters that its rows may have other values of than a declaration fixes, because it scales them.
    kernels : tuple of str, or callable
        The kinds of tasks whose compiled kernels the body asks for, so that they are compiled before the run, and no
        others; ``kernels(options, carried)`` where it depends on the stage.
    systems : mapping of str to callable
        What it is for each other system that it can do beside the VI-NES: ``make(balls)`` returns the kind of the same
        name with the parameters, options, tables and body for that system with so many numbered balls or modes (0 where
        none has a number). Its options have the field ``system``, which so belongs to the key.
    meaningless : mapping of str to str
        Systems that it does not do for what they are, and why; the refusal says so.
    system : str
        The system that it is for.
    balls : int
        How many balls, or modes, of that system have numbers.
    """

    name: str
    summary: str
    shape: Literal["points", "whole"]
    options: type[msgspec.Struct]
    body: str
    tables: tuple[str, ...] = ()
    parameters: Mapping[str, float | None] = field(default_factory=dict)
    vary: Literal["grid", "range", "none"] = "none"
    carry: bool = False
    needs: bool = False
    logs: bool = False
    pictures: bool = False
    check: Callable[[dict[str, float], Any], None] | None = None
    files: Callable[[Any, Path], tuple[Path, ...]] | None = None
    fits: Callable[[Any, Any], None] | None = None
    variants: Register[Any] | None = None
    code: Callable[[Any], tuple[str, ...]] | None = None
    again: Literal["", "points", "long_points", "starts"] = ""
    scaled: tuple[str, ...] = ()
    kernels: tuple[str, ...] | Callable[[Any, bool], tuple[str, ...]] = ()
    systems: Mapping[str, Callable[[int], Kind]] = field(default_factory=dict)
    meaningless: Mapping[str, str] = field(default_factory=dict)
    system: str = VI_NES.name
    balls: int = 0

    def __post_init__(self) -> None:
        if self.shape == "points" and (not self.tables or self.needs or self.pictures or self.vary == "range"):
            raise DeclarationError(
                f"kind {self.name!r}: a kind of the points shape has a primary table, no needs and no pictures, "
                "and varies a grid"
            )
        if self.shape == "whole" and (self.carry or self.vary == "grid"):
            raise DeclarationError(f"kind {self.name!r}: only a kind of the points shape varies a grid or carries")
        if ":" not in self.body:
            raise DeclarationError(f"kind {self.name!r}: body is {self.body!r}; write 'package.module:function'")

    @property
    def variant(self) -> str:
        """The key that names the variant; empty if the options are always the same."""
        return (self.options.__struct_config__.tag_field or "") if self.variants is not None else ""

    def options_of(self, table: Mapping[str, Any]) -> type[msgspec.Struct]:
        """Return the form of the options of a stage that is declared by this table.

        Raises
        ------
        DeclarationError
            If the key that names the variant is missing or names none.
        PlugInError
            If an installed package brings the variant, but not so that it can be used.
        """
        if self.variants is None:
            return self.options
        if self.variant not in table:
            raise DeclarationError(f"{self.variant!r} is missing; allowed: {', '.join(sorted(self.variants.names()))}")
        try:
            return self.variants.get(str(table[self.variant])).options
        except VinesError as error:
            raise type(error)(f"{self.variant}: {error}") from None

    def of_system(self, system: str, balls: int) -> Kind:
        """Return the kind for a system: itself for the VI-NES.

        Raises
        ------
        DeclarationError
            If it cannot do that system; the message lists the systems that it can do, and the kinds that can do this.
        UnknownNameError
            If there is no such system; the message names the nearest.
        """
        if system == VI_NES.name:
            return self
        if system not in system_names():
            raise UnknownNameError(f"unknown system {system!r}: {nearest(system, system_names())}")
        if system not in self.systems:
            others = sorted(name for name, each in kinds().items() if system in each.systems)
            why = f": {self.meaningless[system]}" if system in self.meaningless else ""
            raise DeclarationError(
                f"the kind {self.name!r} cannot do the system {system!r}{why}; it can do "
                f"{', '.join(sorted([VI_NES.name, *self.systems]))}; kinds that can do {system!r}: "
                f"{', '.join(others) or 'none'}"
            )
        return self.systems[system](balls)

    def bodies(self, options: Any) -> tuple[str, ...]:
        """Return everything whose code counts in the keys of a stage with these options, as `body`."""
        return (self.body, *(self.code(options) if self.code is not None else ()))


KINDS: Register[Kind] = Register("kind", "vines.kinds", Kind, DeclarationError)
"""The kinds that are known. Another package brings one by an entry point of the group ``vines.kinds``."""


def register(new: Kind) -> Kind:
    """Make a kind known to declarations and return it. The last registration of a name counts."""
    return KINDS.add(new)


def kinds() -> dict[str, Kind]:
    """Return all kinds by name: those of vines, those registered, those of installed packages.

    Raises
    ------
    PlugInError
        If what an installed package brings is no kind, or cannot be loaded.
    """
    return KINDS.all()


def kind(name: str) -> Kind:
    """Return the kind of that name.

    Raises
    ------
    DeclarationError
        If there is none; the message names the nearest.
    PlugInError
        If an installed package brings it, but not so that it can be used.
    """
    return KINDS.get(name)
