"""The physics of stored rows of systems beside the VI-NES, ball by ball where there are several."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vines import schema
from vines.dynamics import ball_locked, no_ball
from vines.model import most_balls, with_all_balls
from vines.stages.audit._bifurcations import critical_defect, curve_equations
from vines.stages.audit._defect import Defect, forced_amplitude, relative
from vines.stages.audit._modal import damping_of_modes, mobility_of_modes, modal_amplitude
from vines.stages.audit._others import cell_defects
from vines.stages.audit._points import share_defects
from vines.stages.audit._rows import Floats, Rows
from vines.systems import parameters

__all__ = [
    "family_attractor_defects",
    "family_basin_defects",
    "family_bifurcation_defects",
    "family_branch_defects",
    "family_curve_defects",
    "family_impact_defects",
    "family_orbit_defects",
    "family_point_defects",
    "family_transient_defects",
]

_EPSILON = 1e-14
_PRODUCT = 1e-9


def _parameters(table: str, rows: Rows) -> Defect:
    """Return the check of the parameters that a row has; those of a ball that is not there are empty."""
    system = schema.table(table).system
    outside = np.zeros(len(rows))
    for each in with_all_balls(system).parameters:
        if rows.has(each.name):
            value = rows[each.name]
            with np.errstate(invalid="ignore"):
                outside[~np.isnan(value) & ~each.allowed.holds(value)] = np.inf
    return Defect("parameters", "those that the system may have", 0.0, outside)


def _of_ball(rows: Rows, name: str, ball: Floats) -> Floats:
    """Return what the ball of each row has of a parameter: ``name_k`` of ball k, `name` where balls have no number.

    A cavity whose length no parameter tells is the unit of lengths.
    """
    if rows.has(name):
        return rows[name]
    found = np.full(len(rows), np.nan if rows.has(f"{name}_1") else 1.0)
    for number in np.unique(ball[ball > 0]).astype(int):
        found = np.where(ball == number, rows[f"{name}_{number}"], found)
    return found


def _mass(rows: Rows) -> Floats:
    """Return the mass of all balls over that of the frame."""
    names = [name for name in rows.table.column_names if name.partition("_")[0] == "mu"]
    return np.nansum([rows[name] for name in names], axis=0)


def family_impact_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of each row of a table of impacts; balls that hit together share their momentum."""
    yield _parameters(table, rows)
    ball, side, w_dot = rows["ball"], rows["side"], rows["w_dot"]
    new1, new2 = rows["v1_after"], rows["v2_after"]
    size = 1 + np.abs(new1) + np.abs(new2)
    r = _of_ball(rows, "r", ball)
    yield Defect("impact law", "w' after = -r w' before", 1e-12, np.abs(new1 - new2 + r * w_dot) / size)
    half = rows["w"] if rows.has("w") else (rows["x1"] - rows["x2"]) / _of_ball(rows, "beta", ball)
    away = 1 + (np.abs(rows["x1"]) if rows.has("x1") else 0.0)
    contact = np.where(side * w_dot >= 0, np.abs(half - side) / away, np.inf)
    yield Defect("contact", "on the wall of the ball's cavity, met from inside", 1e-11, contact)
    yield Defect("times", "dt_next >= 0", 0.0, np.where(rows["dt_next"] >= 0, 0.0, np.inf))
    if rows.has("v1", "v2"):
        mu = _of_ball(rows, "mu", ball) * (mobility_of_modes(rows) if rows.has("phi_1") else 1.0)
        off = np.abs(rows["v1"] - new1 + mu * (rows["v2"] - new2)) / size
        before = np.append(1.0, rows["dt_next"][:-1])
        alone = (rows["dt_next"] > 0) & (before > 0)
        yield Defect(
            "momentum",
            "v1 + mu v2 is kept by a ball that hits alone, mu over the mass that the cavity answers with",
            1e-12,
            np.where(alone, off, np.nan),
        )


def _balance(rows: Rows, where: np.ndarray, *more: str) -> Iterator[Defect]:
    """Yield the checks of energies: what the base gives is lost or stored."""
    lost = rows["impact_loss_left"] + rows["impact_loss_right"]
    damper = rows["damper_loss"] if rows.has("damper_loss") else np.zeros(len(rows))
    for name in ("electric_power", "friction_power"):
        if rows.has(name):
            damper = damper + rows[name] * rows["duration"]
    change = sum((rows[name] for name in more), np.zeros(len(rows)))
    work = rows["base_work"]
    scale = np.max([np.abs(each) for each in (work, damper, lost, change)], axis=0)
    if rows.has("B"):
        # A ball that rides on the capsule loses nothing: what is left is the rounding of what passes to and fro.
        scale = np.maximum(scale, rows["B"] ** 2)
    off = relative(work, damper + lost + change, scale)
    yield Defect(
        "energy balance", "base_work = what is lost and what is stored more", 1e-9, np.where(where, off, np.nan)
    )
    negative = np.min([damper, rows["impact_loss_left"], rows["impact_loss_right"]], axis=0) < -1e-12 * scale
    yield Defect("losses", "never negative", 0.0, np.where(where, np.where(negative, np.inf, 0.0), np.nan))
    off = relative(rows["impact_power"] * rows["duration"], lost)
    yield Defect("impact power", "impact losses over the window", 1e-9, np.where(where, off, np.nan))
    own = [name for name in rows.table.column_names if name.startswith("impact_power_")]
    if own:
        off = relative(np.nansum([rows[name] for name in own], axis=0), rows["impact_power"])
        yield Defect("balls", "impact_power is the sum over the balls", 1e-9, np.where(where, off, np.nan))


def _yardsticks(table: str, rows: Rows, where: np.ndarray) -> Iterator[Defect]:
    system = schema.table(table).system
    if rows.has("x1_no_ball", "x1_locked", "alpha"):
        # No closed form: found again from the parameters alone.
        names = [each.name for each in with_all_balls(system).parameters]
        points = [
            parameters(system).of(dict(zip(names, values, strict=True)))
            for values in np.stack([rows[name] for name in names], axis=1).tolist()
        ]
        free, locked = (np.array([of(p) for p in points]) for of in (no_ball, ball_locked))
        off = np.maximum(relative(rows["x1_no_ball"], free), relative(rows["x1_locked"], locked))
        yield Defect("yardsticks", "x1_no_ball, x1_locked of the frame alone", 1e-9, np.where(where, off, np.nan))
    elif rows.has("x1_no_ball", "x1_locked"):
        free, locked = (
            modal_amplitude(rows, mass) if rows.has("phi_1") else forced_amplitude(rows, 1.0 + mass)
            for mass in (0.0, _mass(rows))
        )
        off = np.maximum(relative(rows["x1_no_ball"], free), relative(rows["x1_locked"], locked))
        yield Defect("yardsticks", "x1_no_ball, x1_locked in closed form", 1e-9, np.where(where, off, np.nan))


def family_point_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of points."""
    yield _parameters(table, rows)
    done = rows.text("status") == "ok"
    yield from _balance(rows, done, "energy_change")
    yield from _yardsticks(table, rows, done)


def family_attractor_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of attractors."""
    yield _parameters(table, rows)
    yield from share_defects(rows)
    gap = np.zeros(len(rows))
    if rows.has("end_w"):
        gap = np.abs(rows["end_w"]) - 1
    if rows.has("end_x1", "end_x2"):
        walls = rows["walls"] if rows.has("walls") else np.ones(len(rows))
        gap = np.where(walls > 0, np.abs(rows["end_x1"] - rows["end_x2"]) - 1, 0.0)
    for ball in range(1, most_balls(schema.table(table).system) + 1):
        off = np.abs(rows["end_x1"] - rows[f"end_x2_{ball}"]) / rows[f"beta_{ball}"] - 1
        gap = np.fmax(gap, off)
    yield Defect("states", "every ball in its cavity at the end", 1e-9, np.maximum(gap, 0.0))


def family_basin_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of basins."""
    yield _parameters(table, rows)
    yield from cell_defects(rows)


def family_orbit_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of orbits."""
    yield _parameters(table, rows)
    everywhere = np.ones(len(rows), dtype=bool)
    yield from _balance(rows, everywhere)
    yield from _yardsticks(table, rows, everywhere)
    size = np.abs(_multipliers(rows))
    yield _product(rows)
    flat = np.isclose(size.max(axis=1), rows["max_multiplier"], rtol=1e-9)
    right = flat & ((rows["stable"] == 1) == (rows["max_multiplier"] < 1))
    yield Defect("stability", "max_multiplier, and stable where it is below 1", 0.0, np.where(right, 0.0, np.inf))


def family_bifurcation_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of bifurcations."""
    yield _parameters(table, rows)
    yield critical_defect(rows)


def family_branch_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of branches."""
    yield _parameters(table, rows)
    yield Defect("orbits", "one at least", 0.0, np.where(rows["orbits"] >= 1, 0.0, np.inf))


def family_curve_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of curves."""
    yield _parameters(table, rows)
    product = _product(rows)
    # A curve may end where an impact has the speed 1e-3: M is a thousand times its multipliers there, and infinite on a
    # grazing curve of an impact without speed.
    off = np.where(rows.text("type") == "grazing", np.nan, product.values)
    yield Defect(product.name, product.says, 100 * _PRODUCT, off)
    yield from curve_equations(rows)


def _multipliers(rows: Rows) -> np.ndarray:
    return (rows.lists("multipliers_re") + 1j * rows.lists("multipliers_im")).reshape(len(rows), -1)


def _product(rows: Rows) -> Defect:
    """Return the check of the product of the multipliers."""
    m = _multipliers(rows)
    size = np.abs(m)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        off = np.abs(np.prod(m, axis=1) * np.exp(-_log_determinant(rows)) - 1)
        # the small ones carry the rounding error of the largest
        slack = _EPSILON * size.max(axis=1) / size.min(axis=1)
    # Turns and stops of a ball that slides contract too, by ratios of accelerations that rows do not hold.
    told = slack < 1e-2 if not rows.has("friction_power") else np.zeros(len(rows), dtype=bool)
    off = np.where(told, off / (1 + slack / _PRODUCT), np.nan)
    return Defect("multiplier product", "the determinant: r² for each impact, and the dampers", _PRODUCT, off)


def _log_determinant(rows: Rows) -> Floats:
    """Return the logarithm of the product of the multipliers: each impact of a ball contracts by its r²."""
    from vines.model import Word

    codes, known = rows.codes("word")
    found = np.zeros(len(rows))
    for code, text in enumerate(known):
        word, mine = Word(text), codes == code
        for ball in (ball for ball, side in zip(word.balls, word.sides, strict=True) if side):
            r = rows["r"] if rows.has("r") else rows[f"r_{max(ball, 1)}"]
            found[mine] += 2 * np.log(np.maximum(r[mine], 1e-300))
        if rows.has("lam") or rows.has("lam_1"):
            rate = rows["lam"] if rows.has("lam") else damping_of_modes(rows)
            # A damper between two masses acts on both; that of a spring may be at a mass beside the ball.
            for damper, mass in (("delta", "mu"), ("l2", "mu_n" if rows.has("mu_n") else "mu")):
                rate = rate + ((1 + rows[mass]) * rows[damper] if rows.has(damper) else 0.0)
            found[mine] -= (rate * word.p * 2 * np.pi / rows["Omega"])[mine]
    return found


def family_transient_defects(table: str, rows: Rows) -> Iterator[Defect]:
    """Yield the checks of rows of a table of transients."""
    yield _parameters(table, rows)
    done = rows.text("status") == "ok"
    shares = rows["impact_share"] + rows["damper_share"] + rows["left_share"]
    for name in ("electric_share", "friction_share"):
        if rows.has(name):
            shares = shares + rows[name]
    yield Defect("shares", "all that is lost and what is left make 1", 1e-9, np.where(done, np.abs(shares - 1), np.nan))
