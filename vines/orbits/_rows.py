"""Orbits, branches and bifurcations as rows of the tables of those names: plain dicts, whatever they are stored in."""

from __future__ import annotations

from typing import Any

from vines.dynamics import ball_locked, no_ball
from vines.model import X1
from vines.orbits._branch import Bifurcation, Branch
from vines.orbits._orbit import Orbit

__all__ = ["bifurcation_row", "branch_row", "orbit_outline", "orbit_row"]

Row = dict[str, Any]


def orbit_row(orbit: Orbit, branch_id: str | None = None) -> Row:
    """Return the row of the table `orbits`; columns with one value an impact are lists of float.

    Examples
    --------
    >>> from vines.model import Params
    >>> from vines.orbits import find_orbit
    >>> row = orbit_row(find_orbit("LR", Params(mu=0.01, A=0.017)))
    >>> row["name"], row["side"], len(row["t"])
    ('1:1', [1, -1], 2)
    """
    p = orbit.params
    x1, v1, x2, v2 = orbit.states.T
    free = no_ball(p)
    return {
        **orbit_outline(orbit, branch_id),
        "x1": x1.tolist(),
        "v1": v1.tolist(),
        "x2": x2.tolist(),
        "v2": v2.tolist(),
        "x1_no_ball": free,
        "x1_locked": ball_locked(p),
        "reduction": orbit.measures.max_abs_x1 / free,
    }


def orbit_outline(orbit: Orbit, branch_id: str | None = None) -> Row:
    """Return what tables of orbits of every system tell of one; columns with one value an impact are lists."""
    p, measures = orbit.params, orbit.measures
    return {
        "orbit_id": orbit.orbit_id,
        "branch_id": branch_id,
        "word": str(orbit.word),
        "name": orbit.name,
        "alias": orbit.alias,
        "n": orbit.word.n,
        "m": orbit.word.m,
        "p": orbit.word.p,
        "symmetric": orbit.symmetric,
        "stable": orbit.stable,
        "admissible": orbit.admissible,
        **p.as_dict(),
        "t": orbit.t.tolist(),
        "side": orbit.side.tolist(),
        "w_dot": orbit.w_dot.tolist(),
        "phase": orbit.phase.tolist(),
        "multipliers_re": orbit.multipliers.real.tolist(),
        "multipliers_im": orbit.multipliers.imag.tolist(),
        "max_multiplier": orbit.max_multiplier,
        "min_clearance": orbit.min_clearance,
        "violation_time": orbit.violation_time,
        "violation_side": orbit.violation_side,
        "kinetic_ratio": measures.kinetic_ratio,
        "max_abs_x1": measures.max_abs_x1,
        "rms_x1": measures.rms_x1,
        "duration": measures.duration,
        "base_work": measures.base_work,
        "damper_loss": measures.damper_loss,
        "impact_loss_left": measures.impact_loss_left,
        "impact_loss_right": measures.impact_loss_right,
        "residual": orbit.residual,
    }


def branch_row(branch: Branch, parent: str | None = None) -> Row:
    """Return the row of the table `branches`; the parameters are those of the first orbit.

    Parameters
    ----------
    branch : Branch
    parent : str, optional
        Name of the branch that it was switched from; by default what the branch itself knows.
    """
    values = branch.values.tolist()
    return {
        "branch_id": branch.branch_id,
        "word": str(branch.word),
        "name": branch.word.name,
        "symmetric": branch.symmetric,
        "parameter": branch.parameter,
        "from": values[0],
        "to": values[-1],
        "end_from": branch.ends[0],
        "end_to": branch.ends[1],
        "orbits": len(values),
        "parent": branch.parent if parent is None else parent,
        "remark": branch.remark,
        **branch.orbits[0].params.as_dict(),
    }


def bifurcation_row(bifurcation: Bifurcation, branch_id: str | None = None) -> Row:
    """Return the row of the table `bifurcations`, for a bifurcation or an event of a branch."""
    orbit = bifurcation.orbit
    return {
        "branch_id": branch_id,
        "word": str(orbit.word),
        "name": orbit.name,
        "type": bifurcation.type,
        "parameter": bifurcation.parameter,
        "value": bifurcation.value,
        **bifurcation.params.as_dict(),
        "multiplier_re": bifurcation.multiplier.real,
        "multiplier_im": bifurcation.multiplier.imag,
        "orbit_id": orbit.orbit_id,
        "t": (orbit.t - orbit.t[0]).tolist(),
        "side": orbit.side.tolist(),
        "x1": orbit.states[:, X1].tolist(),
        "w_dot": orbit.w_dot.tolist(),
        "phase": orbit.phase.tolist(),
    }
