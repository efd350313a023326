"""The ids of points once more, from the varied values that stand in their rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.pipeline import carried_id, free_ids

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["identities"]


def identities(form: dict[str, Any], primary: pa.Table) -> list[str] | None:
    """Return the id of each point; None where it depends on more than the rows say.

    Parameters
    ----------
    form : dict
        Ingredients of the result: ``vary`` and ``carry``, and perhaps ``refine`` and ``zip``.
    primary : pyarrow.Table
        Its primary table, in the order of the grid: the first axis varies slowest.
    """
    axes = [axis[0] for axis in form["vary"]]
    if "refine" in form or "zip" in form or not set(axes) <= set(primary.column_names):
        return None
    columns: dict[str, npt.NDArray[np.float64]] = {name: np.asarray(primary.column(name)) for name in axes}
    names = sorted(axes)
    if form["carry"] is None:
        return free_ids([columns[name] for name in names] or [np.zeros(primary.num_rows)]).hex()
    counts = [axis[3] for axis in form["vary"]]
    if int(np.prod(counts)) != primary.num_rows:
        return None
    rows = list(zip(*(columns[name].tolist() for name in names), strict=True))
    places = np.moveaxis(np.arange(primary.num_rows).reshape(counts), axes.index(form["carry"]["axis"]), -1)
    found = [""] * primary.num_rows
    for chain in places.reshape(-1, places.shape[-1]).tolist():
        along = columns[form["carry"]["axis"]]
        before = form["carry"]["origin"]
        for place in sorted(chain, key=lambda at: along[at], reverse=form["carry"]["direction"] == "down"):
            before = found[place] = carried_id(before, names, rows[place])
    return found
