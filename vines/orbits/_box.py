"""The parameters that are free in a search for the best orbit, and their ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from vines.errors import ParameterError, nearest
from vines.model import PARAMETER_NAMES, Params

__all__ = ["Box"]

Floats = npt.NDArray[np.float64]


class Box:
    """The ranges of the free parameters, in coordinates from 0 to 1.

    Parameters
    ----------
    p : Params
        The parameters that are held.
    over : mapping of str to (float, float)
        Ranges of the free ones: mu, A, Omega, r, lam, or b, the half length of the cavity in units of the one that `p`
        is for, at a fixed amplitude of the base.

    Raises
    ------
    ParameterError
        If a name or a range is not one.
    """

    def __init__(self, p: Params, over: Mapping[str, tuple[float, float]]) -> None:
        allowed = (*PARAMETER_NAMES, "b")
        if not over:
            raise ParameterError("over is empty; give the range of at least one parameter, such as {'A': (0.01, 0.03)}")
        for name, (low, high) in over.items():
            if name not in allowed:
                raise ParameterError(f"unknown parameter {name!r} in over: {nearest(str(name), allowed)}")
            if not low < high:
                raise ParameterError(f"the range of {name} is {low:g} … {high:g}; give the lower end first")
        if "b" in over and ("A" in over or not over["b"][0] > 0):
            raise ParameterError(
                f"over has b = {over['b'][0]:g} … {over['b'][1]:g}; b has to be positive, and A = E/b must not be free "
                "beside it"
            )
        self.p = p
        self.over = {name: (float(low), float(high)) for name, (low, high) in over.items()}
        self.low = np.array([low for low, _ in self.over.values()])
        self.span = np.array([high for _, high in self.over.values()]) - self.low
        for ends in (np.zeros(len(over)), np.ones(len(over))):
            self.params(ends)

    def params(self, u: Floats) -> Params:
        """Return the parameters at coordinates u, shape (d,)."""
        values = dict(zip(self.over, (self.low + self.span * u).tolist(), strict=True))
        if "b" in values:
            values["A"] = self.p.A / values.pop("b")
        return self.p.replace(**values)

    def b(self, p: Params) -> float:
        """Return the half length of the cavity at these parameters, 1 unless it is free."""
        return self.p.A / p.A if "b" in self.over else 1.0

    def place(self, p: Params) -> Floats:
        """Return the coordinates of parameters, shape (d,)."""
        values = [self.b(p) if name == "b" else getattr(p, name) for name in self.over]
        return (np.array(values) - self.low) / self.span

    def start(self) -> Params:
        """Return the parameters to begin with: those given where they lie in the range, else its middle."""
        u = self.place(self.p)
        return self.params(np.where((u >= 0) & (u <= 1), u, 0.5))

    def lines(self) -> Iterator[tuple[str, float, float]]:
        """Yield each free parameter of the model with its range; for b that is A."""
        for name, (low, high) in self.over.items():
            if name == "b":
                yield "A", self.p.A / high, self.p.A / low
            else:
                yield name, low, high
