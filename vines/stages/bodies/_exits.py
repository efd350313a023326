"""Body of the kind ``exits``: how long regimes hold under noise, and where they are left to."""

from __future__ import annotations

import hashlib
import math
from functools import partial
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from vines.attractors import Exits, exits
from vines.dynamics import Scatter
from vines.model import VI_NES, Params
from vines.pipeline import Batch, Job, Point
from vines.schema import system_table
from vines.stages.bodies._coexisting import attractor_rows
from vines.stages.bodies._family_rows import family_outline, only_own, parameters_of
from vines.stages.bodies._rows import outline

if TYPE_CHECKING:
    from vines.attractors import Attractor
    from vines.stages.kinds.exits import ExitsOptions, FamilyExitsOptions

__all__ = ["compute", "scatter_of"]

TABLES = ("exit_points", "exit_regimes", "exits", "attractors")


def compute(job: Job[ExitsOptions | FamilyExitsOptions]) -> Batch:
    """Watch the runs of every point of the job."""
    options = job.options
    system = getattr(options, "system", VI_NES.name)
    rows: dict[str, list[dict[str, Any]]] = {name: [] for name in TABLES}
    for point in job.points:
        own = {name: value for name, value in point.params.items() if name != "level"}
        p: Any = Params(**own) if system == VI_NES.name else parameters_of(system, own)
        found = _found(p, point, options)
        fixed = {"point_id": point.id, **point.params}
        rows["exit_points"].append(fixed | _point(found))
        rows["exit_regimes"] += [fixed | row for row in _regimes(found)]
        rows["exits"] += [fixed | row for row in _runs(found)]
        told = outline if system == VI_NES.name else partial(family_outline, law=None)
        listed = list(zip(found.attractors, found.found, strict=True))
        described = attractor_rows(point.id, listed, found.starts, told)
        rows["attractors"] += [row if system == VI_NES.name else only_own(p, "attractors", row) for row in described]
    return Batch(tables={system_table(system, name): made for name, made in rows.items()})


def scatter_of(options: Any, point: Point) -> Scatter:
    """Return the noise of a point; what is drawn follows from its id, so that shards agree to the last bit."""
    values = msgspec.structs.asdict(options.scatter)
    if values.get("ou") is not None:
        values["ou"] = msgspec.structs.asdict(values["ou"])
    text = f"{values.pop('seed')} {point.id}"
    seed = int(hashlib.sha256(text.encode()).hexdigest()[:13], 16)
    return Scatter(**values, seed=seed).scaled(point.params["level"])


def _found(p: Any, point: Point, options: Any) -> Exits:
    start = options.start
    return exits(
        p,
        scatter_of(options, point),
        start=start if isinstance(start, dict) else msgspec.structs.asdict(start),
        words=options.words,
        runs=options.runs,
        periods=options.periods,
        confirm=options.confirm,
        wait=options.wait,
        splitting=options.splitting,
        random=options.random,
        seed=options.seed,
        settle=options.settle,
        record=options.record,
        watch=options.watch,
    )


def _name(attractor: Attractor) -> str:
    return attractor.name or attractor.regime


def _point(found: Exits) -> dict[str, Any]:
    started = int(np.argmax(found.found)) if found.starts else None
    held = int(np.argmax(found.law[0]))
    return {
        "regimes": len(found.attractors),
        "runs": len(found.runs),
        "exits": int((~found.runs["censored"]).sum()),
        "most_started": started,
        "most_started_name": _name(found.attractors[started]) if started is not None else None,
        "most_probable": held,
        "most_probable_name": _name(found.attractors[held]),
        "status": "ok",
        "reason": "",
    }


def _regimes(found: Exits) -> list[dict[str, Any]]:
    rows = []
    share, low, high = found.law
    for each in (*found.holdings, *found.split):
        attractor = found.attractors[each.regime]
        basin, error = found.basin(each.regime)
        left = sum(each.to.values())
        rows.append(
            {
                "attractor": each.regime,
                "regime": attractor.regime,
                "name": attractor.name,
                "method": each.method,
                "relaxation": _there(relaxation(attractor)),
                "runs": each.runs,
                "wait": float(found.wait),
                "early": each.early,
                "exits": each.exits,
                "watched": each.watched,
                "mean": _there(each.mean),
                "mean_low": _there(each.low),
                "mean_high": _there(each.high),
                "to": sorted(each.to),
                "to_share": [each.to[k] / left for k in sorted(each.to)],
                "long_run": share[each.regime],
                "long_run_low": low[each.regime],
                "long_run_high": high[each.regime],
                "basin": _there(basin),
                "basin_error": _there(error),
                "remark": each.remark or None,
            }
        )
    return rows


def relaxation(attractor: Attractor) -> float:
    """Return the forcing periods in which a small disturbance of a periodic attractor falls to 1/e; else nan."""
    size = attractor.max_multiplier
    return -(attractor.p or 0) / math.log(size) if 0.0 < size < 1.0 else math.nan


def _there(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _runs(found: Exits) -> list[dict[str, Any]]:
    rows = []
    for regime, seed, time, to, censored, excursions in found.runs.tolist():
        rows.append(
            {
                "attractor": regime,
                "seed": seed,
                "T_exit": time,
                "to": None if censored else to,
                "censored": censored,
                "excursions": excursions,
            }
        )
    return rows
