"""Rows of the tables ``reconstructions`` and ``rig_impacts``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vines.rig.quantities import IMPACT, NOTED, QUANTITIES, SOURCES, Reconstruction
from vines.rig.recording import RunInfo

__all__ = ["budget_rows", "failed_row", "impact_columns", "reconstruction_row"]


def reconstruction_row(found: Reconstruction, ring_downs: Sequence[str]) -> dict[str, Any]:
    """Return the row of a run in ``reconstructions``.

    Parameters
    ----------
    found : Reconstruction
    ring_downs : sequence of str
        The runs that gave omega0 and lam.
    """
    pattern = found.pattern
    failed = [finding for finding in found.findings if not finding.passed]
    row = {
        **_head(found.run, ring_downs),
        "status": "ok",
        "reason": None,
        "accepted": found.accepted,
        "fault": any(finding.fault for finding in failed),
        "failed": " ".join(finding.name for finding in failed),
        "findings": found.reasons,
        "noted": "; ".join(each.text for each in found.findings if each.passed and each.name in NOTED),
        "pattern": pattern.name,
        "n": pattern.n,
        "m": pattern.m,
        "p": pattern.p,
        "word": " ".join(pattern.word),
        "fraction": pattern.fraction,
        "fractions": ", ".join(f"{name} {share:.4f}" for name, share in pattern.fractions.items()),
        "holds": pattern.holds,
        "periods": len(found.periods.words),
        "impacts": len(found.impacts),
        "suspect": int(np.count_nonzero(found.impacts["suspect"])),
        "pruned": found.pruned,
        "residual": found.residual,
        "noise": found.noise,
        "sha256": found.sha256,
    }
    for name in QUANTITIES:
        one = found.quantities.get(name)
        known = one is not None and math.isfinite(one.value) and math.isfinite(one.u)
        row[name], row[f"u_{name}"] = (one.value, one.u) if one is not None and known else (None, None)
    return row


def budget_rows(found: Reconstruction) -> list[dict[str, Any]]:
    """Return the rows of a run in ``rig_budgets``: what each source adds to the uncertainty of each quantity."""
    run = found.run.run_id
    return [
        {
            "point_id": f"{run}/{quantity}/{source}",
            "run_id": run,
            "quantity": quantity,
            "source": source,
            "u": abs(u),
            "u_source": found.sources.get(source),
            "unit_source": SOURCES[source][0] if source in found.sources else None,
        }
        for quantity, parts in found.budget.items()
        for source, u in parts.items()
        if math.isfinite(u)
    ]


def failed_row(
    run_id: str, start_utc: str | None, reason: str, run: RunInfo | None = None, ring_downs: Sequence[str] = ()
) -> dict[str, Any]:
    """Return the row of a run that cannot be reconstructed, or not even read if `run` is left out."""
    head = {"point_id": run_id, "run_id": run_id, "start_utc": start_utc} if run is None else _head(run, ring_downs)
    return {**head, "status": "failed", "reason": reason, "accepted": False, "holds": False}


def _head(run: RunInfo, ring_downs: Sequence[str]) -> dict[str, Any]:
    return {
        "point_id": run.run_id,
        "run_id": run.run_id,
        "start_utc": run.start_utc,
        "protocol": run.protocol,
        "temperature": float(np.mean(run.temperature)),
        "ringdown": " ".join(ring_downs),
    }


def impact_columns(runs: Sequence[Reconstruction]) -> Mapping[str, Any]:
    """Return the columns of ``rig_impacts``: the impacts of each run, one run after the other."""
    import pyarrow as pa

    names = [found.run.run_id for found in runs for _ in range(len(found.impacts))]
    rows = np.concatenate([found.impacts for found in runs]) if runs else np.zeros(0, IMPACT)
    columns: dict[str, Any] = {"point_id": names, "run_id": names}
    columns["index"] = np.concatenate([np.arange(len(found.impacts)) for found in runs] or [np.zeros(0, np.int64)])
    for name in IMPACT.names or ():
        values = rows[name].astype(np.int8) if name == "side" else np.ascontiguousarray(rows[name])
        columns[name] = pa.array(values, from_pandas=True)  # what is not known is empty, not nan
    return columns
