"""A family of orbits that was followed in one parameter, and what was met on it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from vines.html import html_table
from vines.model import Params, Word
from vines.orbits._orbit import Orbit, short_hash

__all__ = ["Bifurcation", "Branch"]


@dataclass(frozen=True, eq=False)
class Bifurcation:
    """A bifurcation, located by the root of its defining equation.

    Attributes
    ----------
    type : str
        fold, symmetry_breaking, period_doubling, neimark_sacker, grazing or tie; of orbits that stick also
        incomplete_chatter and release_tangency, where they end; in `Branch.events` pair_turns_real.
    parameter : str
        The parameter in which the branch was followed.
    value : float
        Its value there.
    params : Params
        All parameters there.
    multiplier : complex
        The critical Floquet multiplier over pT; nan for grazing.
    half_multiplier : complex
        For a symmetric orbit that of the half map, -1 at a symmetry breaking; else `multiplier`.
    orbit : Orbit
        The orbit there; at an end of a family that sticks or stops, next to it.
    """

    type: str
    parameter: str
    value: float
    params: Params
    multiplier: complex
    half_multiplier: complex
    orbit: Orbit

    @property
    def word(self) -> Word:
        """Word of the orbit."""
        return self.orbit.word

    def __repr__(self) -> str:
        return f"<Bifurcation {self.type} of {self.orbit.name} at {self.parameter} = {self.value:.12g}>"


@dataclass(frozen=True, eq=False)
class Branch:
    """A family of orbits followed in one parameter.

    Attributes
    ----------
    word : Word
    parameter : str
    orbits : tuple of Orbit
        In the order of travel, with the orbits at the bifurcations among them.
    bifurcations : tuple of Bifurcation
        In the order of travel.
    events : tuple of Bifurcation
        What is worth a remark but changes no stability: pair_turns_real, where two multipliers meet on the real
        axis and a complex pair becomes two real ones, or the reverse.
    ends : tuple of str, str
        Why the branch begins and ends where it does: ``range`` (of the parameter), ``closed`` (both ends are one orbit:
        the family is an isola), ``grazing``, ``symmetry_breaking``
        or ``period_doubling`` (where it comes out of another family), ``incomplete_chatter`` or ``release_tangency``
        (of orbits that stick), ``crossing_sliding``, ``switching_sliding``, ``adding_sliding`` or ``grazing_sliding``
        (with friction), ``points`` (as many as were allowed), ``lost`` (the corrector failed at the smallest step).
    parent : str or None
        Name of the branch that it was switched from, if it was.
    remark : str
        What could not be followed out of it, and why; empty if nothing.
    """

    word: Word
    parameter: str
    orbits: tuple[Orbit, ...]
    bifurcations: tuple[Bifurcation, ...]
    events: tuple[Bifurcation, ...]
    ends: tuple[str, str]
    parent: str | None = None
    remark: str = ""

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """Values of the parameter at the orbits."""
        return np.array([orbit.params.as_dict()[self.parameter] for orbit in self.orbits])

    @property
    def symmetric(self) -> bool:
        """Whether the orbits are their own mirror images; one that joins a symmetric family at its end may be."""
        return all(orbit.symmetric for orbit in self.orbits)

    @cached_property
    def branch_id(self) -> str:
        """Name of the branch, from its parameter and its first and last orbits."""
        return short_hash(self.word, self.parameter, self.orbits[0].orbit_id, self.orbits[-1].orbit_id)

    def __repr__(self) -> str:
        first, last = self.values[[0, -1]]
        met = ", ".join(f"{b.type} at {b.value:.6g}" for b in self.bifurcations) or "no bifurcation"
        return (
            f"<Branch {self.word}, {self.parameter} from {first:g} to {last:g}, {len(self.orbits)} orbits, {met}; "
            f"ends: {', '.join(self.ends)}>"
        )

    def _repr_html_(self) -> str:
        """Return the branch as a small table, which a notebook shows."""
        first, last = self.values[[0, -1]]
        met = [f"{each.type.replace('_', ' ')} at {each.value:.6g}" for each in (*self.bifurcations, *self.events)]
        return html_table(
            f"Branch of {self.word}",
            {
                self.parameter: f"from {first:.6g} to {last:.6g}",
                "orbits": f"{len(self.orbits)}, {sum(orbit.stable for orbit in self.orbits)} of them stable",
                "symmetric": self.symmetric,
                "met": met or "no bifurcation",
                "ends": [each.replace("_", " ") for each in self.ends],
                "remark": self.remark or None,
            },
        )
