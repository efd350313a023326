"""What can be told of the rows that follow from measurements: identities between their columns, and plausibility."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from vines.stages.audit._defect import Defect, relative
from vines.stages.audit._rows import Floats, Rows

__all__ = ["comparison_defects", "cycle_defects", "reconstruction_defects", "rig_impact_defects"]


_IN_CONTACT = 1e-4
"""Longest time from the touch of the ball to the centroid of the force [s]: a contact lasts .2 ms at most."""

_TURNING = 0.05
"""A quarter of the largest deceleration of the ball by friction, .02 g: if its sense turns in the middle of a flight,
the mean velocity is off by that times the duration [m/s^2]."""


def reconstruction_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``reconstructions``."""
    done = rows.text("status") == "ok"

    def where(values: Floats) -> Floats:
        return np.where(done, values, np.nan)

    yield Defect("amplitude", "A = E/b", 1e-12, where(relative(rows["A"] * rows["b"], rows["E"])))
    turning = relative(rows["Omega"] * rows["omega0"], 2 * np.pi * rows["f"])
    yield Defect("frequency ratio", "Omega = 2 pi f/omega0", 1e-12, where(turning))
    holds = np.isin(rows.text("pattern").astype(str), ("mixed", "none"), invert=True)
    wrong = ((rows["holds"] == 1) != holds) | (holds & (rows["fraction"] < 0.95))
    yield Defect("pattern", "holds in at least 95 % of the periods, else mixed", 0.0, where(_inf(wrong)))
    yield Defect("word", "n and m count its letters, p its periods", 0.0, where(_inf(_miscounted(rows))))
    quiet = rows.text("failed").astype(str) == ""
    yield Defect("gates", "accepted where none failed", 0.0, where(_inf((rows["accepted"] == 1) != quiet)))
    count = (rows["suspect"] > rows["impacts"]) | (rows["impacts"] < 0)
    yield Defect("impacts", "no more are suspect than there are", 0.0, where(_inf(count)))


def rig_impact_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``rig_impacts``."""
    off = np.fmax(
        np.abs(rows["w_dot"] - (rows["v1"] - rows["v2"])),
        np.abs(rows["w_dot_after"] - (rows["v1_after"] - rows["v2_after"])),
    )
    yield Defect("relative velocity", "w_dot = v1 - v2, before and after [m/s]", 1e-9, off)
    yield Defect("restitution", "r = -w_dot_after/w_dot", 1e-9, np.abs(rows["r"] * rows["w_dot"] + rows["w_dot_after"]))
    side = rows["side"]
    yield Defect("side", "+1 or -1", 0.0, _inf(np.abs(side) != 1))
    run = rows.codes("run_id")[0]
    same = np.concatenate([[False], run[1:] == run[:-1]]) if len(rows) else np.zeros(0, dtype=bool)
    half, speed = side * (rows["x1"] - rows["x2"]), np.abs(rows["w_dot"])
    usual = _medians(half, run)
    off = np.abs(half - usual) / np.fmax(speed, _medians(speed, run))
    says = "side (x1 - x2) = b in all impacts of a run, but for how deep the ball goes in: in .1 ms at its speed [s]"
    yield Defect("walls", says, _IN_CONTACT, np.where(half > 0, off, np.inf))
    step = _inf(~(np.diff(rows["t"], prepend=np.nan) > 0) | (np.diff(rows["index"], prepend=np.nan) != 1))
    yield Defect("order", "times rise, one number after the other", 0.0, np.where(same, step, np.nan))
    mean, time = 0.5 * (rows["v2"][1:] + rows["v2_after"][:-1]), np.diff(rows["t"])
    flown = np.concatenate([[np.nan], (np.diff(rows["x2"]) - mean * time) / time**2]) if len(rows) else mean
    says = "the ball flies from wall to wall at the mean of its velocities, but for friction that turns [m/s^2]"
    yield Defect("flights", says, _TURNING, np.where(same, np.abs(flown), np.nan))


def comparison_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``comparisons``."""
    errors = np.stack([rows[f"E_n_{name}"] for name in ("phase", "max_abs_x1", "kinetic_ratio")])
    off = np.zeros(len(rows))
    for error, name in zip(errors, ("phase", "max_abs_x1", "kinetic_ratio"), strict=True):
        gap = rows[name] - rows[f"model_{name}"]
        gap = (gap + np.pi) % (2 * np.pi) - np.pi if name == "phase" else gap
        own = np.abs(gap) / (2 * np.hypot(rows[f"u_{name}"], rows[f"u_model_{name}"]))
        off = np.fmax(off, relative(error, own))
    there = np.isfinite(errors).any(axis=0)
    yield Defect("E_n", "|measured - model|/(2 sqrt(u^2 + u_model^2))", 1e-6, np.where(there, off, np.nan))
    verdict = rows.text("verdict")
    nearest = rows["rank"] == 0
    far = (verdict == "agree") & nearest & ~(errors <= 1).all(axis=0)
    kept = (rows["accepted"] == 1) & ~np.isin(rows.text("pattern").astype(str), ("mixed", "none", "None"))
    wrong = far | ((verdict != "undecidable") & ~kept)
    yield Defect(
        "verdict", "agree where every E_n <= 1; undecidable where a gate failed or nothing holds", 0.0, _inf(wrong)
    )
    basis, own, other = rows.text("basis"), rows.text("run_id"), rows.text("calibrated_on")
    used = [
        b == "calibrated" and (o is None or name in o.split()) for b, name, o in zip(basis, own, other, strict=True)
    ]
    yield Defect("calibration", "on other runs than those it is scored on", 0.0, _inf(np.array(used, dtype=bool)))


def cycle_defects(rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of the table ``rig_cycles``."""
    table = rows.table.to_pylist()
    sizes = [len({len(row[name]) for name in ("time", "w", "w_dot", "model_w", "model_w_dot")}) > 1 for row in table]
    yield Defect("lengths", "the curves of a row have one length", 0.0, _inf(np.array(sizes, dtype=bool)))
    shares = np.array([max(sum(row[name]) for name in ("wait_share", "model_wait_share")) for row in table])
    yield Defect("shares", "no more than all waits", 1e-9, np.maximum(shares - 1, 0.0) if table else np.zeros(0))


def _miscounted(rows: Rows) -> npt.NDArray[np.bool_]:
    """Return where n, m and p are not those of the word."""
    words = [str(word).split() for word in rows.text("word")]
    n, m = (np.array(["".join(word).count(end) for word in words]) for end in "LR")
    p = np.array([max(len(word), 1) for word in words])
    return (rows["n"] != n) | (rows["m"] != m) | (rows["p"] != p)


def _medians(values: Floats, run: npt.NDArray[np.intp]) -> Floats:
    """Return for each row the median over its run; what is not known counts for nothing."""
    found = np.full(len(values), np.nan)
    for each in np.unique(run):
        own = values[run == each]
        found[run == each] = np.median(own[np.isfinite(own)]) if np.isfinite(own).any() else np.nan
    return found


def _inf(wrong: npt.NDArray[np.bool_]) -> Floats:
    return np.where(wrong, np.inf, 0.0)
