"""A bifurcation that was followed in two parameters, and the points of codimension two on it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.model import Word
from vines.orbits._orbit import Orbit, short_hash

__all__ = ["Curve", "SpecialPoint", "curve_rows"]


@dataclass(frozen=True, eq=False)
class SpecialPoint:
    """A point of codimension two on a curve.

    Attributes
    ----------
    type : str
        cusp; resonance_1_1 … resonance_1_4; fold_flip, fold_symmetry_breaking, fold_neimark_sacker,
        flip_neimark_sacker, symmetry_breaking_neimark_sacker; degenerate_period_doubling,
        degenerate_symmetry_breaking; grazing, where the orbits of the curve cease to be admissible; tie, where two
        balls hit together, beyond which their impacts have changed places; on grazing
        curves grazing_fold, grazing_flip, grazing_symmetry_breaking, grazing_neimark_sacker, double_grazing,
        degenerate_grazing, and the first four of these by their names on curves of incomplete_chatter and
        release_tangency. Docs/orbits.md says what each is.
    values : tuple of float, float
        The two parameters there.
    orbit : Orbit
        The orbit there.
    """

    type: str
    values: tuple[float, float]
    orbit: Orbit

    def __repr__(self) -> str:
        return f"<SpecialPoint {self.type} of {self.orbit.name} at {self.values[0]:.9g}, {self.values[1]:.9g}>"


@dataclass(frozen=True, eq=False)
class Curve:
    """A bifurcation followed in two parameters.

    Attributes
    ----------
    type : str
        fold, symmetry_breaking, period_doubling, neimark_sacker or grazing; of orbits that stick also
        incomplete_chatter and release_tangency.
    word : Word
    symmetric : bool
        Whether the orbits are their own mirror images.
    parameters : tuple of str, str
    orbits : tuple of Orbit
        The orbits at the points, in order along the curve.
    residuals : (n,) float array
        Largest of the equations at each point.
    special : tuple of SpecialPoint
        In order along the curve.
    ends : tuple of str, str
        Why it ends at either end: ``box``, ``grazing`` (of a curve of another type: its orbits cease to be
        admissible), ``tie``, ``double_grazing``, ``degenerate_grazing``, ``resonance_1_1`` or ``resonance_1_2`` (of a
        Neimark-Sacker curve, whose pair turns real), ``incomplete_chatter`` or ``release_tangency`` (beyond which
        orbits that stick do not), ``closed``, ``points`` (as many as were allowed), ``domain``
        (next to where the system, or its steady response, does not exist), ``rounding`` (the equations are left with
        fewer than nine digits), ``lost``.
    """

    type: str
    word: Word
    symmetric: bool
    parameters: tuple[str, str]
    orbits: tuple[Orbit, ...]
    residuals: npt.NDArray[np.float64]
    special: tuple[SpecialPoint, ...]
    ends: tuple[str, str]

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """The two parameters at the points, shape (n, 2)."""
        points = [orbit.params.as_dict() for orbit in self.orbits]
        return np.array([[point[name] for name in self.parameters] for point in points])

    @cached_property
    def curve_id(self) -> str:
        """Name of the curve, from its type, parameters and first and last orbits."""
        return short_hash(self.type, *self.parameters, self.orbits[0].orbit_id, self.orbits[-1].orbit_id)

    def __repr__(self) -> str:
        met = ", ".join(f"{s.type} at ({s.values[0]:.6g}, {s.values[1]:.6g})" for s in self.special) or "none"
        return (
            f"<Curve {self.type} of {self.word} in {', '.join(self.parameters)}, {len(self.orbits)} points, "
            f"special: {met}; ends: {', '.join(self.ends)}>"
        )


def curve_rows(curve: Curve) -> list[dict[str, Any]]:
    """Return the rows of a curve: one a point with ``special`` null, then one a special point, as plain dicts."""
    common = {
        "curve_id": curve.curve_id,
        "type": curve.type,
        "word": str(curve.word),
        "name": curve.word.name,
        "symmetric": curve.symmetric,
        "parameter_1": curve.parameters[0],
        "parameter_2": curve.parameters[1],
    }
    places = [(None, orbit) for orbit in curve.orbits] + [(point.type, point.orbit) for point in curve.special]
    return [
        {
            **common,
            "point": k if special is None else None,
            "special": special,
            **orbit.params.as_dict(),
            "multipliers_re": orbit.multipliers.real.tolist(),
            "multipliers_im": orbit.multipliers.imag.tolist(),
            "min_clearance": orbit.min_clearance,
            "admissible": orbit.admissible,
            "orbit_id": orbit.orbit_id,
        }
        for k, (special, orbit) in enumerate(places)
    ]
