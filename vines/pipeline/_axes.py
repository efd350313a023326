"""Axes: the values of a varied parameter, exact rationals of the declared decimals, rounded once.

In floating point 401 and 1201 points of one range share only some values; computed exactly they share all 401, so a
refined grid computes only its new points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from vines.errors import DeclarationError, nearest
from vines.pipeline._written import written

if TYPE_CHECKING:
    import numpy as np

__all__ = ["Axis", "exact", "read_axis"]

_RANGE_KEYS = ("count", "from", "log", "step", "to")
_MOST = 10_000_000
_EXACT = 2**53
_DIGITS = 50


@dataclass(frozen=True)
class Axis:
    """A varied parameter.

    Attributes
    ----------
    name : str
        The parameter.
    form : {"list", "linear", "log", "range"}
        Listed values, so many values evenly spaced, the same on a logarithmic scale, or an interval without values.
    ends : tuple of Fraction
        The ends as declared; all values of a list.
    count : int
        How many values; 0 for an interval.
    """

    name: str
    form: Literal["list", "linear", "log", "range"]
    ends: tuple[Fraction, ...]
    count: int

    def values(self) -> tuple[float, ...]:
        """Return the values, ascending unless the axis is zipped with another.

        Examples
        --------
        >>> Axis("A", "linear", (Fraction("0.1"), Fraction("0.4")), 4).values()
        (0.1, 0.2, 0.3, 0.4)
        >>> Axis("A", "log", (Fraction(1), Fraction(100)), 3).values()
        (1.0, 10.0, 100.0)
        """
        if self.form == "list":
            return tuple(float(value) for value in self.ends)
        if self.count == 1:
            return (float(self.ends[0]),)
        if self.form == "log":
            return _logarithms(self.ends[0], self.ends[-1], self.count)
        start, step, denominator = self._line()
        # the quotient of two whole numbers is rounded correctly, once
        return tuple((start + step * i) / denominator for i in range(self.count))

    def at(self, places: np.ndarray) -> np.ndarray:
        """Return the values at some places, the same bit by bit as :meth:`values` gives, for many at once."""
        import numpy as np

        if self.form == "linear" and self.count > 1:
            start, step, denominator = self._line()
            if max(abs(start), abs(start + step * (self.count - 1)), denominator) < _EXACT:
                # whole numbers that floats hold exactly: one division rounds as Python's does
                return (start + step * places.astype(np.int64)).astype(np.float64) / float(denominator)
        return self._array[places]

    def value(self, position: Fraction) -> float:
        """Return the value at a position between places, rounded once; whole numbers are the places themselves.

        Examples
        --------
        >>> Axis("A", "linear", (Fraction("0.1"), Fraction("0.4")), 4).value(Fraction(1, 2))
        0.15
        """
        if self.form == "log":
            return _logarithmic(self.ends[0], self.ends[-1], position / (self.count - 1))
        if self.form == "linear":
            start, stop = self.ends
            return float(start + (stop - start) * position / (self.count - 1))
        place = min(int(position), self.count - 2)
        return float(self.ends[place] + (self.ends[place + 1] - self.ends[place]) * (position - place))

    def _line(self) -> tuple[int, int, int]:
        """Return whole numbers a, b and c such that the value at place i is (a + b i)/c."""
        first, last = self.ends
        step = (last - first) / (self.count - 1)
        denominator = math.lcm(first.denominator, step.denominator)
        return int(first * denominator), int(step * denominator), denominator

    @cached_property
    def _array(self) -> np.ndarray:
        import numpy as np

        return np.array(self.values())

    def canonical(self) -> list[Any]:
        """Return the declaration as plain data, the same however the decimals were written."""
        return [self.name, self.form, [str(end) for end in self.ends], self.count]


def exact(value: object, where: str) -> Fraction:
    """Return a number of a declaration as a rational.

    Raises
    ------
    DeclarationError
        If it is not a finite number.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | Decimal):
        give = f"{value:d}" if isinstance(value, bool) else "a finite number"
        raise DeclarationError(f"{where} is {written(value)}, which is not a number; give {give}")
    # a float that comes from Python stands for the shortest decimal that it prints as
    decimal = Decimal(repr(value)) if isinstance(value, float) else Decimal(value)
    if not decimal.is_finite():
        raise DeclarationError(f"{where} is {value}; give a finite number")
    return Fraction(decimal)


def read_axis(name: str, form: object, where: str, *, interval: bool, zipped: bool = False) -> Axis:
    """Read ``vary.<name>``.

    Parameters
    ----------
    name : str
        The parameter.
    form : object
        A list of numbers, or a table with ``from``, ``to`` and one of ``count`` and ``step``, and ``log`` if wanted.
    where : str
        File and key, for messages.
    interval : bool
        Whether the kind covers an interval: only ``from`` and ``to`` then.
    zipped : bool
        Whether the values run together with those of another axis: they stay in the order declared, and may repeat.

    Raises
    ------
    DeclarationError
        If it is neither, a key is unknown, or the numbers contradict each other.
    """
    if isinstance(form, list) and not interval:
        return _read_list(name, form, where, zipped=zipped)
    allowed = ("from", "to") if interval else _RANGE_KEYS
    if not isinstance(form, Mapping):
        shape = "{ from = …, to = … }" if interval else "{ from = …, to = …, count = … } or a list"
        raise DeclarationError(f"{where} is {written(form)}; write {shape}")
    for key in form:
        if key not in allowed:
            raise DeclarationError(f"{where}: unknown key {key!r}: {nearest(key, allowed)}")
    for key in ("from", "to"):
        if key not in form:
            raise DeclarationError(f"{where}: {key!r} is missing; a range has both ends")
    start, stop = exact(form["from"], f"{where}.from"), exact(form["to"], f"{where}.to")
    if interval:
        return Axis(name, "range", (start, stop), 0)
    axis = _read_range(name, form, (start, stop), where)
    return axis if zipped else Axis(name, axis.form, (min(axis.ends), max(axis.ends)), axis.count)


def _read_list(name: str, form: list[object], where: str, *, zipped: bool) -> Axis:
    values = tuple(exact(value, f"{where}[{i}]") for i, value in enumerate(form))
    if not values:
        raise DeclarationError(f"{where} is empty; list at least one value")
    if zipped:
        return Axis(name, "list", values, len(values))
    if len({float(value) for value in values}) < len(values):
        raise DeclarationError(f"{where} lists a value twice; each point is computed once")
    return Axis(name, "list", tuple(sorted(values)), len(values))


def _read_range(name: str, form: Mapping[str, object], ends: tuple[Fraction, Fraction], where: str) -> Axis:
    start, stop = ends
    if ("count" in form) == ("step" in form):
        raise DeclarationError(f"{where}: give either 'count' or 'step' beside 'from' and 'to'")
    logarithmic = form.get("log", False)
    if not isinstance(logarithmic, bool):
        raise DeclarationError(f"{where}.log is {written(logarithmic)}; allowed: true, false")
    if logarithmic and (min(ends) <= 0 or "step" in form):
        raise DeclarationError(f"{where}: a logarithmic range has ends > 0 and a 'count'")
    if "step" in form:
        step = exact(form["step"], f"{where}.step")
        steps = (stop - start) / step if step > 0 else Fraction(-1)
        if steps < 0 or steps.denominator != 1:
            text = f"step {float(step):g} does not lead from {float(start):g} to {float(stop):g}"
            raise DeclarationError(f"{where}: {text} in a whole number of steps > 0")
        count = int(steps) + 1
    else:
        count = form["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= _MOST:
        raise DeclarationError(f"{where}.count is {written(count)}; allowed is a whole number from 1 to {_MOST}")
    if (start == stop) != (count == 1):
        only = f"to take {float(start):g} alone write vary.{name} = [{float(start):g}]"
        remedy = f"a count of 2 or more takes both ends; {only}" if count == 1 else only
        raise DeclarationError(
            f"{where}.count is {count}, from {float(start):g} to {float(stop):g}, which cannot be; {remedy}"
        )
    return Axis(name, "log" if logarithmic else "linear", ends, count)


def _logarithms(first: Fraction, last: Fraction, count: int) -> tuple[float, ...]:
    """Return evenly spaced values on a logarithmic scale; each product adds 1e-60, far below the last place."""
    context = Context(prec=_DIGITS + 10)
    low, high = _ln(first, context), _ln(last, context)
    ratio = context.exp(context.divide(context.subtract(high, low), Decimal(count - 1)))
    value = context.divide(Decimal(first.numerator), Decimal(first.denominator))
    inner = [float(value := context.multiply(value, ratio)) for _ in range(count - 2)]
    return (float(first), *inner, float(last))


def _logarithmic(first: Fraction, last: Fraction, part: Fraction) -> float:
    if part in (0, 1):
        return float(last if part else first)
    context = Context(prec=_DIGITS)
    low, high = _ln(first, context), _ln(last, context)
    share = context.divide(Decimal(part.numerator), Decimal(part.denominator))
    return float(context.exp(context.add(low, context.multiply(context.subtract(high, low), share))))


def _ln(value: Fraction, context: Context) -> Decimal:
    return context.ln(context.divide(Decimal(value.numerator), Decimal(value.denominator)))
