"""Body of the kind ``curve``: bifurcations of a word followed in two parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vines.errors import DeclarationError, OrbitNotFound
from vines.model import Params
from vines.orbits import Bifurcation, Curve, curve_rows, follow_curve, follow_families, own_word
from vines.pipeline import Batch, WholeJob

if TYPE_CHECKING:
    from vines.stages.kinds.curve import CurveOptions

__all__ = ["compute", "followed", "rows_of"]

_NEAR = 0.01
"""Largest distance, relative to the range, of a bifurcation from a curve between whose points it lies, to be on it."""

_SLOW = 0.01
"""Impact speed below which those of two orbits are compared absolutely: at some grazings it vanishes."""


def compute(job: WholeJob[CurveOptions]) -> Batch:
    """Find the bifurcations on lines through the box and follow each that lies on no curve yet, both ways."""
    curves = followed(job, lambda values: Params(**values))
    return Batch(tables={"curves": [row for curve in curves for row in rows_of(curve)]})


def followed(job: WholeJob[Any], form: Callable[[dict[str, float]], Any]) -> list[Curve]:
    """Return the curves.

    Parameters
    ----------
    job : WholeJob
        With the options of the kind, whatever the system.
    form : callable
        Makes the parameters of the system from their flat names.

    Raises
    ------
    OrbitNotFound
        If there is none.
    """
    options = job.options
    if len(job.ranges) != 2:
        raise DeclarationError(f"a curve is followed in two parameters, this one varies {len(job.ranges)}")
    first, second = job.ranges
    box = {name: (min(span.start, span.stop), max(span.start, span.stop)) for name, span in job.ranges.items()}
    curves: list[Curve] = []
    for value in _between(*box[second], options.lines):
        p = form({**job.params, first: box[first][0], second: value})
        for bifurcation in _bifurcations(options, p, first, box[first]):
            if not any(_lies_on(bifurcation, curve, box) for curve in curves):
                curves.append(follow_curve(bifurcation, (first, second), box=box, step=options.step))
    if not curves:
        raise OrbitNotFound(
            f"no {options.type} of {options.word} on {options.lines} lines along {first} through the box; "
            "give another box, or more lines or seeds"
        )
    return curves


def _between(low: float, high: float, count: int) -> list[float]:
    """Return values inside a range, the middle one first; by ratio where the range spans a decade."""
    shares = sorted(((k + 0.5) / count for k in range(count)), key=lambda share: (abs(share - 0.5), share))
    if low > 0 and high / low >= 10:
        return [low * (high / low) ** share for share in shares]
    return [low + (high - low) * share for share in shares]


def _bifurcations(options: CurveOptions, p: Any, parameter: str, within: tuple[float, float]) -> Iterator[Bifurcation]:
    word = own_word(options.word, p)
    # Inside the range, since a curve does not begin at its border.
    seeds = np.linspace(*within, options.seeds + 2)[1:-1].tolist()
    # Of what comes out of a family only what has broken its symmetry has the same word.
    depth = 1 if word.symmetric and p.mirrored else 0
    for branch in follow_families(options.word, p, parameter, within, seeds=seeds, depth=depth):
        if branch.word == word:
            yield from (found for found in branch.bifurcations if found.type == options.type)


def _lies_on(bifurcation: Bifurcation, curve: Curve, box: dict[str, tuple[float, float]]) -> bool:
    """Say whether a curve passes through a bifurcation, as far as the polygon through its points tells."""
    orbit = bifurcation.orbit
    # Where a parameter of the plane breaks the symmetry the curve goes on to orbits without it.
    if curve.symmetric != (orbit.symmetric and not set(box) & set(orbit.params.system.mirror.broken_by)):
        return False
    spans = np.array([high - low for low, high in box.values()])
    place = np.array([bifurcation.params.as_dict()[name] for name in box]) / spans
    points = curve.values / spans
    steps = np.diff(points, axis=0)
    squares = np.maximum((steps**2).sum(axis=1), 1e-300)
    share = np.clip(((place - points[:-1]) * steps).sum(axis=1) / squares, 0, 1)
    distance = np.linalg.norm(points[:-1] + share[:, None] * steps - place, axis=1)
    k = int(np.argmin(distance))
    if distance[k] > _NEAR:
        return False
    # Two sheets may cross in the plane of parameters; their orbits differ.
    near = curve.orbits[k].w_dot + share[k] * (curve.orbits[k + 1].w_dot - curve.orbits[k].w_dot)
    images = [orbit.w_dot, *([-np.roll(orbit.w_dot, 1)] if len(orbit.word) == 2 and orbit.params.mirrored else [])]
    return any(np.abs(near - image).max() < 0.05 * max(np.abs(image).max(), _SLOW) for image in images)


def rows_of(curve: Curve) -> list[dict[str, Any]]:
    """Return the rows of a curve, with residuals and ends."""
    rows = curve_rows(curve)
    for row, residual in zip(rows, curve.residuals.tolist(), strict=False):
        row["residual"] = residual
    rows[0]["end"], rows[len(curve.orbits) - 1]["end"] = curve.ends
    return rows
