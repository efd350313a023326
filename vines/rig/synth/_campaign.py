"""A synthetic campaign: a sweep of the base amplitude up and down, with ring-downs and a rig that warms up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from vines.errors import ParameterError
from vines.rig.synth._make import make_run
from vines.rig.synth._settings import RigSettings, draw_settings

__all__ = ["make_campaign"]

_DISPLACED = 0.012
"""[m] From where the oscillator is let go in a ring-down."""


def make_campaign(
    folder: Path,
    *,
    amplitudes: Sequence[float],
    seed: int,
    draw: bool = False,
    warming: float = 0.0,
    given: Mapping[str, Any] | None = None,
) -> list[dict[str, Any]]:
    """Write the run folders of a campaign: ring-down, sweep up, ring-down, sweep down, ring-down.

    A run goes on from the end of the one before, so that coexisting motions are met from both sides.

    Parameters
    ----------
    folder : Path
        Where the run folders go; the truth goes to ``sealed`` beside it.
    amplitudes : sequence of float
        Commanded A = E/b, rising.
    seed : int
        Of everything that is drawn.
    draw : bool
        Draw the imperfections of the rig over their ranges.
    warming : float
        Change of temperature over the campaign [K].
    given : mapping, optional
        Settings that are not drawn.

    Returns
    -------
    list of dict
        The rows of ``rig_made``.

    Raises
    ------
    ParameterError
        If a rig cannot be so.
    StoreError
        If a run folder exists.
    """
    try:
        settings = msgspec.convert(dict(given or {}), RigSettings)
    except msgspec.ValidationError as unfit:
        raise ParameterError(f"settings of the synthetic rig: {unfit}") from None
    if draw:
        settings = draw_settings(seed, **{name: getattr(settings, name) for name in (given or {})})
    plan: list[tuple[str, str, float]] = [("ringdown", "ringdown", 0.0)]
    plan += [("up", "sweep_up", A) for A in amplitudes]
    plan += [("ringdown", "ringdown", 0.0)]
    plan += [("down", "sweep_down", A) for A in reversed(amplitudes)]
    plan += [("ringdown", "ringdown", 0.0)]
    names = [f"{k:02d}_{what}" for k, (what, _, _) in enumerate(plan)]
    resting = [k for k, (_, protocol, _) in enumerate(plan) if protocol == "ringdown"]
    begin = settings.temperature[0]
    rows: list[dict[str, Any]] = []
    state: np.ndarray | None = None
    for k, (name, (_, protocol, A)) in enumerate(zip(names, plan, strict=True)):
        warm = tuple(begin + warming * (k + part) / len(plan) for part in (0, 1))
        change: dict[str, Any] = {"run_id": name, "protocol": protocol, "temperature": warm}
        change["start_utc"] = (
            str(np.datetime64(settings.start_utc.rstrip("Z"), "s") + np.timedelta64(600 * k, "s")) + "Z"
        )
        if protocol == "ringdown":
            change |= {"ball": False, "settle": 0.0, "start": (_DISPLACED, 0.0, 0.0, 0.0), "recorders": 1, "false": 0.0}
        else:
            before, after = max(r for r in resting if r < k), min(r for r in resting if r > k)
            change |= {"E": A * settings.b, "ringdown": (names[before], names[after])}
        one = msgspec.structs.replace(settings, **change)
        run = make_run(
            folder / name, one, seed + k, None if protocol == "ringdown" else state, folder.parent / "sealed"
        )
        if protocol != "ringdown":
            state = run.end
        size = sum(path.stat().st_size for path in (folder / name / "raw").iterdir())
        rows.append(
            {
                "point_id": name, "run_id": name, "protocol": protocol, "seed": seed + k, "form": one.form,
                "channels": len(run.rows), "duration": one.duration, "bytes": size,
            }
        )  # fmt: skip
    return rows
