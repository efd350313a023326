"""Kinds of stages: light specifications and their register."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import DeclarationError, nearest

if TYPE_CHECKING:
    import msgspec

__all__ = ["Kind", "kind", "kinds", "register"]


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
        Whether it makes MCAP logs, or ``picture.png`` and ``picture.svg``.
    check : callable, optional
        ``check(params, options)`` raises :class:`vines.errors.ParameterError` (or `StateError`) when these
        cannot be. Called with the corners of the declared box before anything is written.
    files : callable, optional
        ``files(options, root)`` returns the files whose contents belong to the key, such as published claims.
    kernels : tuple of str, or callable
        The kinds of tasks whose compiled kernels the body asks for, so that they are compiled before the run, and no
        others; ``kernels(options, carried)`` where it depends on the stage.
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
    kernels: tuple[str, ...] | Callable[[Any, bool], tuple[str, ...]] = ()


_REGISTER: dict[str, Kind] = {}


def register(new: Kind) -> Kind:
    """Make a kind known to declarations and return it. The last registration of a name counts.

    Raises
    ------
    DeclarationError
        If the specification contradicts itself.
    """
    if new.shape == "points" and (not new.tables or new.needs or new.pictures or new.vary == "range"):
        raise DeclarationError(
            f"kind {new.name!r}: a kind of the points shape has a primary table, no needs and no pictures, "
            "and varies a grid"
        )
    if new.shape == "whole" and (new.carry or new.vary == "grid"):
        raise DeclarationError(f"kind {new.name!r}: only a kind of the points shape varies a grid or carries")
    if ":" not in new.body:
        raise DeclarationError(f"kind {new.name!r}: body is {new.body!r}; write 'package.module:function'")
    _REGISTER[new.name] = new
    return new


def kinds() -> dict[str, Kind]:
    """Return the registered kinds by name, in the order of registration."""
    return dict(_REGISTER)


def kind(name: str) -> Kind:
    """Return the kind of that name.

    Raises
    ------
    DeclarationError
        If there is none; the message names the nearest.
    """
    try:
        return _REGISTER[name]
    except KeyError:
        raise DeclarationError(f"unknown kind {name!r}: {nearest(name, _REGISTER)}") from None
