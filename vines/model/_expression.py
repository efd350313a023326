"""Formulas of numbers and names with + - * / and parentheses: read by Python's own grammar, nothing else allowed."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from vines.errors import ParameterError, nearest

__all__ = ["Expression"]

_MOST = 200
_HOW = "write numbers and names of parameters with + - * / and parentheses, such as '0.02 - mu_1'"
_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.UAdd: lambda a: +a,
    ast.USub: lambda a: -a,
}


@dataclass(frozen=True)
class Expression:
    """A formula of parameters.

    Parameters
    ----------
    text : str
        Numbers, which are taken as the decimals that are written, and names.
    functions : mapping of str to callable
        Functions of one number that it may call.

    Raises
    ------
    ParameterError
        If it has anything else.

    Examples
    --------
    >>> Expression("0.02 - mu_1").value({"mu_1": Fraction("0.005")})
    Fraction(3, 200)
    >>> Expression("2*(A + 1)/B").names
    ('A', 'B')
    >>> Expression("A**2")
    Traceback (most recent call last):
    vines.errors.ParameterError: 'A**2' is no formula: write numbers and names of parameters with + - * / and ...
    """

    text: str
    functions: Mapping[str, Callable[[Any], Any]] | None = None

    def __post_init__(self) -> None:
        assert self.names is not None  # reads it

    @cached_property
    def _tree(self) -> ast.expr:
        try:
            if not isinstance(self.text, str) or len(self.text) > _MOST:
                raise ValueError
            return ast.parse(self.text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise ParameterError(f"{self.text!r} is no formula: {_HOW}") from None

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names in it, in their order, each once."""
        found: dict[str, None] = {}
        self._walk(self._tree, found)
        return tuple(found)

    def value(self, values: Mapping[str, Any], number: Callable[[Any], Any] = Fraction) -> Any:
        """Return its value.

        Parameters
        ----------
        values : mapping of str to number
            Values of the names, of the type that `number` makes.
        number : callable
            Makes a number of what is written: exact by default.

        Raises
        ------
        ParameterError
            If a name has no value, or something is divided by 0.
        """
        try:
            return self._value(self._tree, values, number)
        except ZeroDivisionError:
            raise ParameterError(f"{self.text!r} divides by 0") from None

    @cached_property
    def canonical(self) -> str:
        """The same text however it was spaced."""
        return ast.unparse(self._tree)

    def _walk(self, node: ast.expr, found: dict[str, None]) -> None:
        match node:
            case ast.Name():
                found[node.id] = None
            case ast.Constant() if isinstance(node.value, int | float) and not isinstance(node.value, bool):
                self._constant(node, Fraction)
            case ast.UnaryOp() if type(node.op) in _OPERATORS:
                self._walk(node.operand, found)
            case ast.BinOp() if type(node.op) in _OPERATORS:
                self._walk(node.left, found)
                self._walk(node.right, found)
            case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in (self.functions or ()):
                self._walk(argument, found)
            case _:
                raise ParameterError(f"{self.text!r} is no formula: {_HOW}")

    def _value(self, node: ast.expr, values: Mapping[str, Any], number: Callable[[Any], Any]) -> Any:
        match node:
            case ast.Name():
                if node.id not in values:
                    raise ParameterError(f"{self.text!r} names {node.id!r}: {nearest(node.id, values)}")
                return values[node.id]
            case ast.Constant():
                return self._constant(node, number)
            case ast.UnaryOp():
                return _OPERATORS[type(node.op)](self._value(node.operand, values, number))
            case ast.BinOp():
                sides = (self._value(side, values, number) for side in (node.left, node.right))
                return _OPERATORS[type(node.op)](*sides)
            case ast.Call(func=ast.Name(id=name), args=[argument]):
                return (self.functions or {})[name](self._value(argument, values, number))
        raise AssertionError(node)

    def _constant(self, node: ast.Constant, number: Callable[[Any], Any]) -> Any:
        """Return a number from its decimals: a float would have rounded them."""
        try:
            return number(ast.get_source_segment(self.text.strip(), node))
        except ValueError:
            raise ParameterError(f"{self.text!r} is no formula: {_HOW}") from None
