"""The physics of recorded impacts: the law of impact, momentum, and the flights from one impact to the next."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.model import PARAMETER_NAMES, START_NAMES, STATE_NAMES
from vines.stages.audit._cycles import Cycles
from vines.stages.audit._defect import Defect, relative
from vines.stages.audit._flights import Flights
from vines.stages.audit._rows import Floats, Rows

__all__ = ["POINT_COLUMNS", "impact_defects", "motion_defects"]

_COMPARED = (
    *("mu", "duration", "impact_loss_left", "impact_loss_right", "base_work", "damper_loss"),
    *("kinetic_1", "kinetic_2", "rms_x1", "max_abs_x1"),
)
POINT_COLUMNS = ("point_id", "status", "sticks_per_period", "settled", "regime", "n", "m", *_COMPARED)
"""What has to be known of the points that impacts belong to."""


def impact_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of each row of the table ``impacts`` by itself."""
    v1, v2, mu, r = rows["v1"], rows["v2"], rows["mu"], rows["r"]
    new1, new2 = rows["v1_after"], rows["v2_after"]
    size = 1 + np.abs(v1) + np.abs(v2)
    outside = [~(np.isfinite(rows[name]) & (rows[name] >= 0)) for name in PARAMETER_NAMES]
    yield Defect("parameters", "those of the model", 0.0, np.where(np.any(outside, axis=0), np.inf, 0.0))
    yield Defect("momentum", "v1 + mu v2 is kept", 1e-12, np.abs(v1 + mu * v2 - new1 - mu * new2) / size)
    yield Defect("impact law", "w' after = -r w' before", 1e-12, np.abs(new1 - new2 + r * (v1 - v2)) / size)
    approach = np.where(rows["side"] * rows["w_dot"] >= 0, 0.0, np.inf)
    contact = np.max(
        [np.abs(rows["x1"] - rows["x2"] - rows["side"]), np.abs(v1 - v2 - rows["w_dot"]) / size, approach], axis=0
    )
    yield Defect("contact", "w = ±1, met from inside; w' = v1 - v2", 1e-11, contact)
    yield Defect("times", "dt_next > 0", 0.0, np.where(rows["dt_next"] > 0, 0.0, np.inf))


def motion_defects(
    rows: Rows, points: Rows, which: npt.NDArray[np.int64], flying: npt.NDArray[np.bool_]
) -> Iterator[tuple[Defect, npt.NDArray[np.int64]]]:
    """Yield the checks of what lies between impacts, and the rows of ``impacts`` that their values stand for.

    Parameters
    ----------
    rows : Rows
        Rows of ``impacts``, whole points only.
    points : Rows
        The table ``points`` that they belong to.
    which : (n,) int array
        Row of `points` for each impact, -1 if there is none.
    flying : (n,) bool array
        Whether the ball flies from impact to impact on the attractor of the row; where it sticks it may not.
    """
    places = np.flatnonzero(flying & (which >= 0))
    if not len(places):
        return
    chosen = rows.take(flying & (which >= 0))
    state = {name: chosen[name] for name in START_NAMES}
    flights = Flights.of(chosen, slice(None), {**state, "dt": chosen["dt_next"]})
    number = np.nan_to_num(chosen["attractor"])
    # one number for each run of impacts: the point and which of its attractors
    owner = which[places] * (int(number.max(initial=0)) + 1) + number.astype(np.int64)
    yield Defect("next impact", "where the flight lands", 1e-9, _landing(chosen, flights, owner)), places
    beyond = np.maximum(flights.sums().largest_gap - 1, 0.0)
    yield Defect("admissibility", "|w| < 1 until the next impact", 1e-9, beyond), places
    own = np.flatnonzero(number == 0)
    if len(own):
        part = chosen.take(number == 0)
        yield from _periodic(part, points, flights.take(own), which[places[own]], places[own])


def _landing(rows: Rows, flights: Flights, owner: npt.NDArray[np.int64]) -> Floats:
    """Return how far each flight lands from the impact that follows; nan if none is stored."""
    off = np.full(len(rows), np.nan)
    follows = (owner[1:] == owner[:-1]) & (rows["index"][1:] == rows["index"][:-1] + 1)
    landed = flights.land()
    stored = [rows[name] for name in STATE_NAMES]
    gap = np.max([np.abs(a[:-1] - b[1:]) for a, b in zip(landed, stored, strict=True)], axis=0)
    turned = np.abs(
        np.exp(1j * (rows["phase"] + rows["Omega"] * rows["dt_next"])[:-1]) - np.exp(1j * rows["phase"][1:])
    )
    elapsed = np.abs(rows["t"][1:] - rows["t"][:-1] - rows["dt_next"][:-1])
    off[:-1] = np.where(follows, np.max([gap, turned, elapsed], axis=0), np.nan)
    return off


def _periodic(
    rows: Rows, points: Rows, flights: Flights, owner: npt.NDArray[np.int64], places: npt.NDArray[np.int64]
) -> Iterator[tuple[Defect, npt.NDArray[np.int64]]]:
    """Yield the checks of points against their impacts, where one repetition of a periodic attractor is kept."""
    first = np.flatnonzero(np.diff(owner, prepend=-1) != 0)
    lengths = np.diff(np.append(first, len(owner)))
    at = owner[first]
    whole = (points["settled"][at] == 1) & (points.text("regime")[at] == "periodic")
    whole &= lengths == points["n"][at] + points["m"][at]
    if not whole.any():
        return
    chosen = np.repeat(whole, lengths)
    cycles = Cycles(flights.take(np.flatnonzero(chosen)), lengths[whole])
    at, begins, sums = at[whole], places[first[whole]], cycles.sums
    own: Any = {name: points[name][at] for name in _COMPARED}
    yield Defect("repetition", "the impacts kept of a periodic attractor close", 1e-7, cycles.closure), begins
    left, right = cycles.losses(rows["side"][chosen])
    both = left + right
    scale = np.abs(own["damper_loss"]) + both
    period = own["duration"]
    values = np.max(
        [
            relative(own["impact_loss_left"], left, both),
            relative(own["impact_loss_right"], right, both),
            relative(own["base_work"], sums.base_work, scale),
            relative(own["damper_loss"], sums.damper_loss, scale),
            relative(own["kinetic_1"], 0.5 * sums.v1_square / period),
            relative(own["kinetic_2"], 0.5 * own["mu"] * sums.v2_square / period),
            relative(own["rms_x1"] ** 2, sums.x1_square / period),
            relative(own["max_abs_x1"], sums.largest_x1),
        ],
        axis=0,
    )
    yield Defect("measures of points", "from the impacts of one repetition, by quadrature", 1e-6, values), begins
