"""The best stable orbit of a word over some parameters, and how robust it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from vines.domains import Name, Named, Number, Pair, Parameters, stated
from vines.errors import ParameterError, nearest
from vines.model import VI_NES, Params, Word, word_for
from vines.orbits._best import Search
from vines.orbits._box import Box
from vines.orbits._margins import Margin, margins_of
from vines.orbits._orbit import Orbit

__all__ = ["OBJECTIVES", "Optimum", "optimise"]

OBJECTIVES = ("max_abs_x1", "kinetic_ratio")


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best stable orbit found.

    Attributes
    ----------
    objective : str
        ``max_abs_x1`` (least) or ``kinetic_ratio`` (largest).
    value : float
        Its value; with b free, b max|x1|, that is max|q1| in units of the half length of the cavity that `p` is for.
    orbit : Orbit
    b : float
        Half length of the cavity in units of that which `p` is for; 1 unless it was free.
    over : dict of str to (float, float)
        The parameters that were free and their ranges.
    active : tuple of str
        What keeps the optimum where it is: types of bifurcations, and ends of ranges as ``least mu`` or ``largest mu``.
        Empty if it lies inside.
    margins : dict of str to Margin
        The first bifurcations below and above in each parameter, and in b if it was free.
    """

    objective: str
    value: float
    orbit: Orbit
    b: float
    over: dict[str, tuple[float, float]]
    active: tuple[str, ...]
    margins: dict[str, Margin]

    @property
    def nearest(self) -> tuple[float, str, str]:
        """The nearest bifurcation: distance relative to the parameter's value, parameter, type; inf, "", "" if none."""
        met = [(*margin.nearest, name) for name, margin in self.margins.items() if margin.nearest[1]]
        distance, kind, name = min(met, default=(math.inf, "", ""))
        return distance, name, kind

    def __repr__(self) -> str:
        held = ", ".join(self.active) or "nothing"
        return f"<Optimum {self.objective} = {self.value:.9g}, held by {held}: {self.orbit}>"


@stated(
    ParameterError,
    p=Parameters(any_system=False),
    objective=Name(),
    over=Named(Pair()),
    largest_multiplier=Number(),
)
def optimise(
    word: str | Word,
    objective: str,
    p: Params,
    over: Mapping[str, tuple[float, float]],
    *,
    largest_multiplier: float = 1.0,
) -> Optimum:
    """Return the stable admissible orbit of a word with least max|x1| or largest K2/K1 over ranges of parameters.

    Parameters
    ----------
    word : str or Word
    objective : str
        ``max_abs_x1``, to be least, or ``kinetic_ratio``, to be largest.
    p : Params
        The parameters that are held; those that are free begin here if it lies in their range.
    over : mapping of str to (float, float)
        Ranges of the free ones: mu, A, Omega, r, lam, or b. b is the half length of the cavity in units of the one that
        `p` is for, at a fixed amplitude E of the base: then A = p.A/b, and max_abs_x1 means b max|x1|.
    largest_multiplier : float
        Multipliers over pT are kept inside this radius, <= 1; a smaller one asks for faster recovery.

    Returns
    -------
    Optimum

    Raises
    ------
    ParameterError
        If the objective, a name or a range is not one.
    OrbitNotFound
        If no stable admissible orbit of the word was met.

    Notes
    -----
    Branches through the box are followed in each free parameter from all orbits of the word, through folds and
    unstable stretches. The best stable orbits on them are improved in all free parameters at once: SLSQP in coordinates
    on the surface of orbits, with bifurcations and grazing as smooth constraints. Branches are followed again from
    there, until nothing is gained (docs/optimum.md). This finds the best of what hangs together in this way; it
    is no proof that nothing is better.

    Examples
    --------
    >>> best = optimise("LR", "max_abs_x1", Params(mu=0.01, A=0.015), {"b": (0.5, 3.0)})
    >>> print(f"{best.value:.5f} at b = {best.b:.4f}", best.active, best.orbit.stable)
    0.21006 at b = 1.5461 () True
    """
    word = word_for(word, VI_NES, sticking=False)
    if objective not in OBJECTIVES:
        raise ParameterError(f"unknown objective {objective!r}: {nearest(str(objective), OBJECTIVES)}")
    if not 0 < largest_multiplier <= 1:
        raise ParameterError(f"largest_multiplier is {largest_multiplier!r}, allowed is 0 < largest_multiplier <= 1")
    search = Search(word, objective, Box(p, over), largest_multiplier)
    best = search.run()
    box = search.box
    b = box.b(best.params)
    margins = margins_of(best)
    if "b" in box.over:
        margins["b"] = _cavity_margin(margins["A"], b)
    return Optimum(objective, abs(search.cost(best)), best, b, dict(box.over), search.active(best), margins)


def _cavity_margin(amplitude: Margin, b: float) -> Margin:
    """Return the margin in b from that in A: A b is held."""
    force = amplitude.here * b
    return Margin("b", b, force / amplitude.above, amplitude.above_type, force / amplitude.below, amplitude.below_type)
