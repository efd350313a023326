"""From a recording to the quantities of the model, with uncertainties and gates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from vines.errors import RigError
from vines.rig.ball import (
    FRICTION,
    LINEARITY,
    ROLLS,
    SWAPPED,
    TILT,
    BallMotion,
    Rebounds,
    ball_motion,
    mean_restitution,
    measure_rebounds,
    stated,
    uncalibrated,
)
from vines.rig.camera import see_ball
from vines.rig.fit import Forced, JumpModel, Push, Train, forced_response, push, root, slide
from vines.rig.impacts import Mode, Response, measure_response, still_rings, undisturbed, without_ringing
from vines.rig.quantities._budget import length_parts, quotient, source_values, tuned
from vines.rig.quantities._camera import with_camera
from vines.rig.quantities._cycle import Track, slots
from vines.rig.quantities._findings import judge
from vines.rig.quantities._forcing import Base, Rubbed, Tuning, measure_base, tune
from vines.rig.quantities._hum import Hum, without_hum
from vines.rig.quantities._limits import limits, stiffened
from vines.rig.quantities._pattern import Pattern, Periods, cut_into_periods, find_pattern
from vines.rig.quantities._reconstruction import IMPACT, Finding, Reconstruction
from vines.rig.quantities._ring_down import RingDown, natural
from vines.rig.quantities._trends import MATTERS, base_course, run_trends, trend_findings
from vines.rig.recording import Recording, Uncertain
from vines.rig.uncertainty import combined, mean_over_periods, standard_error

__all__ = ["reconstruct"]

Floats = npt.NDArray[np.float64]

_BESIDE = 3e-3
"""An impact that is nearer to a stretch without signal is marked [s]."""


def reconstruct(
    recording: Recording,
    ringdowns: Sequence[RingDown],
    *,
    impacts: tuple[Floats, Floats] | None = None,
    seed: int = 0,
) -> Reconstruction:
    """Reconstruct a run.

    Parameters
    ----------
    recording : Recording
        Of protocol ``dwell``, ``sweep_up`` or ``sweep_down``, ball in.
    ringdowns : sequence of RingDown
        Before and after it, best both.
    impacts : tuple of ndarray, optional
        Times of the impacts [s] on the clock of the oscillator's channel and velocity jumps of the oscillator [m/s],
        where they are known otherwise; then nothing is detected.
    seed : int
        Of the draws for uncertainties.

    Returns
    -------
    Reconstruction

    Raises
    ------
    RigError
        If the run is a ring-down, a channel is missing, no ring-down is at hand, there are fewer than six impacts, or
        a fit has no solution.

    Notes
    -----
    docs/rig.md, "Reconstruct".
    """
    try:
        return _reconstructed(recording, ringdowns, impacts, seed)
    except np.linalg.LinAlgError as error:
        raise RigError(
            f"run {recording.run.run_id!r}: a fit has no solution ({error}): samples or impacts are too few, or a "
            "channel is constant; look at it with 'vines rig inspect'"
        ) from None


def _reconstructed(
    recording: Recording, ringdowns: Sequence[RingDown], impacts: tuple[Floats, Floats] | None, seed: int
) -> Reconstruction:
    run = recording.run
    if run.protocol == "ringdown" or not run.ball:
        raise RigError(f"run {run.run_id!r} has no ball in it; a ring-down gives omega0 and lam, see ring_down")
    base = measure_base(recording)
    recorded = recording
    recording, hum = without_hum(recording, base.f.value)
    if hum is not None:
        base = measure_base(recording)
    omega0, lam = natural(tuple(ringdowns), float(np.mean(run.temperature)))
    omega = base.fit.omega
    s = root(omega0.value, lam.value)
    forced = _harmonics(base, recording, s)
    friction = stated(run.more.get("friction"), FRICTION)
    assumed = friction.value
    mu = run.m.value / run.M.value
    sight = see_ball(recording, s, omega)

    def measure(recording: Recording, gain: complex | None = None) -> Response:
        return measure_response(
            recording, s, omega, forced, seen=None if sight is None else sight.train(mu),
            friction=mu * assumed, u_natural=(omega0.u / omega0.value, lam.u / lam.value),
            driven=complex(forced_response(base.e[0], omega, s)), impacts=impacts, gain=gain, seed=seed,
        )  # fmt: skip

    modes: tuple[Mode, ...] = ()
    if impacts is None:
        recording, response, modes = undisturbed(recording, measure)
        if modes:
            # Beside modes that ring hum is read wrongly, and the base moves as its sensor's stand does.
            recording, hum = without_hum(without_ringing(recorded, response, modes), base.f.value)
            base = measure_base(recording)
            forced = _harmonics(base, recording, s)
            response = measure(recording, response.gain)
    else:
        response = measure(recording)
    if len(response.fit.jumps.t) < 6:
        raise RigError(
            f"run {run.run_id!r} shows {len(response.fit.jumps.t)} impacts, allowed are 6 and more: did the ball move?"
        )
    side = -np.sign(response.fit.jumps.dv)
    bend = stiffened(ringdowns, response)
    omega0 = combined(omega0.value, omega0.u, omega0.value * bend.value, omega0.value * bend.u)
    tuning = _tuned(base, omega0, lam, response, forced, mu, run.b.value, friction, assumed)
    if impacts is None and tuning.rubbing.value - tuning.rubbing.u > ROLLS:
        # What so much friction does to the oscillator would pass for jumps that are smaller.
        assumed = tuning.rubbing.value
        response = measure(recording, response.gain)
        side = -np.sign(response.fit.jumps.dv)
        tuning = _tuned(base, omega0, lam, response, forced, mu, run.b.value, friction, assumed)
    span = (response.bins.t[0] - response.late, response.bins.t[-1] - response.late)
    phase = omega * (response.fit.jumps.t - response.late) + base.phase.value + tuning.phase
    bounds = tuple(omega * t + base.phase.value + tuning.phase for t in span)
    periods = cut_into_periods(phase, side, (bounds[0], bounds[1]))
    pattern = find_pattern(periods, phase)
    ball = measure_rebounds(recording, response, side, tuning.friction, tuning.rubbing)
    made = _assembled(recording, base, response, side, tuning, phase, periods, pattern, ball, (omega0, lam))
    model = JumpModel(response.bins, s, omega, response.order, forced)
    course = base_course(base)
    trends = {**course.trends, **run_trends(base, response, tuning, ball, model)}
    findings = (
        *_taken_off(recording, hum, modes, int(np.count_nonzero(made.impacts["bridged"]))),
        *trend_findings(recording, course, trends),
        *_ringing_on(response),
        *limits(recording, base, response, tuning, ball, ringdowns, modes),
        *judge(recording, base, response, tuning, ball),
    )
    found = replace(made, quantities={**made.quantities, **trends}, findings=_named(findings))
    return found if sight is None else with_camera(found, sight, ball.gauge)


def _bridged(recording: Recording, t: Floats) -> npt.NDArray[np.bool_]:
    """Say which impacts have samples without signal beside them, in a channel of the oscillator."""
    beside = np.zeros(len(t), bool)
    for channel in recording.channels.values():
        if channel.role in ("lo_disp", "lo_vel") and not channel.valid.all():
            bad = channel.start + np.flatnonzero(~channel.valid) / channel.rate
            place = np.searchsorted(bad, t)
            near = np.minimum(
                np.abs(bad[np.maximum(place - 1, 0)] - t), np.abs(bad[np.minimum(place, len(bad) - 1)] - t)
            )
            beside |= near < _BESIDE
    return beside


def _taken_off(recording: Recording, hum: Hum | None, modes: tuple[Mode, ...], bridged: int) -> list[Finding]:
    """Return what was found of hum, modes and lost signal, which is no fault once it is dealt with."""
    lost = {
        channel.name: channel.about["bursts"] for channel in recording.channels.values() if channel.about.get("bursts")
    }
    found = [] if hum is None else [Finding("hum", True, hum.text)]
    if lost:
        text = "; ".join(f"{name} {each}" for name, each in lost.items())
        found.append(Finding("lost_signal", True, f"{text}; {bridged} of the impacts are beside such a stretch"))
    if modes:
        listed = "; ".join(mode.text for mode in modes)
        found.append(
            Finding("frame_modes", True, f"modes of the frame ring after impacts and were taken off, {listed}")
        )
    return found


def _ringing_on(response: Response) -> list[Finding]:
    """Return that modes are left in the channel which tells the restitution, where they are."""
    left = still_rings(response)
    if left is None:
        return []
    size, frequencies = left
    about = ", ".join(f"{f:.3g}" for f in frequencies)
    return [
        Finding(
            "frame_modes_left", False,
            f"modes of the frame ring after impacts, about {about} Hz, and could not be taken off: {size:.2g} times "
            f"the noise of {response.channel.name} is left on the mean, and with it r is not known",
        )
    ]  # fmt: skip


def _named(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Return findings without guesses that a run which changes, or modes, give rise to.

    It shifts one sensor's impacts, too, and its mean response is no answer to its mean forcing. What rings on after
    impacts looks like a base that follows, and like contacts that last.
    """
    guesses: tuple[str, ...] = ()
    if any(each.name in (*MATTERS, "levels") and not each.passed for each in findings):
        guesses += ("oscillator_clocks", "forcing", "sliding_ball")
    if any(each.name == "frame_modes_left" for each in findings):
        guesses += ("base_reacts", "short_contact", "sliding_ball")
    return tuple(each for each in findings if each.name not in guesses)


def _harmonics(base: Base, recording: Recording, s: complex) -> Forced:
    """Return harmonics 2 to 5 of the forced response by the base's own, and what linearity adds to them."""
    n = np.arange(2, 6)
    e = np.zeros(4, complex)
    e[: len(base.e) - 1] = base.e[1:5]
    c = forced_response(e, n * base.fit.omega, s)
    channel = recording.role("lo_disp")
    size = float(np.std(channel.values[channel.valid])) if channel is not None else 50 * base.E.value
    return c, 0.03 * np.abs(c) + size * np.array([3e-4, 5e-4, 1e-4, 1e-4])


def _asked(c: npt.NDArray[np.complex128], s: complex, omega: float) -> npt.NDArray[np.complex128]:
    """Return the base motion that a forced response belongs to."""
    return c / forced_response(1.0, omega, s)


def _tuned(
    base: Base,
    omega0: Uncertain,
    lam: Uncertain,
    response: Response,
    forced: Forced,
    mu: float,
    b: float,
    friction: Uncertain,
    assumed: float,
) -> Tuning:
    """Lay the forced response beside the base; its slopes by omega0, lam and friction are differences of more fits."""
    omega, fit = base.fit.omega, response.fit
    s = root(omega0.value, lam.value)
    turn = np.exp(1j * omega * response.late)

    train = Train.alike(fit.motion.starts[1:], fit.jumps.dv, 2e-5)

    def again(omega0_: float, lam_: float, pushed: Push | None = response.pushed) -> complex:
        moved = root(omega0_, lam_)
        model = JumpModel(response.bins, moved, omega, response.order, forced)
        other = model.fit(train, pushed=pushed, fair=fit.fair, draws=0)
        return complex(_asked(other.motion.c[:1], moved, omega)[0] * turn)

    first = np.concatenate([fit.motion.c[:1], fit.first])
    asked = _asked(first, s, omega) * turn
    step = 2e-5
    here = again(omega0.value, lam.value)
    by_omega0 = (again(omega0.value * (1 + step), lam.value) - here) / step
    by_lam = (again(omega0.value, lam.value * 1.02) - here) / 0.02
    assumed = 0.0 if response.pushed is None else assumed
    sliding = slide(fit.motion, fit.jumps.x + np.sign(fit.jumps.dv) * b)
    size = mu * (assumed + 1.0) / abs(s) ** 2
    more = push(sliding, fit.motion.starts[1:], response.bins.t, s, size, response.order)
    by_friction = again(omega0.value, lam.value, more) - here
    return tune(
        base, omega0, lam, asked, (by_omega0, by_lam), Rubbed(friction, assumed, by_friction),
        u_gain=response.channel.u_gain, u_time=response.u_late, u_noise=SWAPPED,
    )  # fmt: skip


def _assembled(
    recording: Recording, base: Base, response: Response, side: Floats, tuning: Tuning, phase: Floats,
    periods: Periods, pattern: Pattern, ball: Rebounds, natural_: tuple[Uncertain, Uncertain],
) -> Reconstruction:  # fmt: skip
    run, fit = recording.run, response.fit
    complete = len(periods.words)
    if complete < 8:
        raise RigError(f"run {run.run_id!r} holds {complete} whole forcing periods, a reconstruction needs 8")
    number = periods.number - periods.first
    inner = number[1:-1]
    inside = (inner >= 0) & (inner < complete)
    use = ball.counted & inside
    speed = np.abs(ball.motion.w_before)

    def mean(values: Floats, which: npt.NDArray[np.bool_], size: Floats | None = None) -> Uncertain:
        return mean_over_periods(values[which], inner[which], complete, None if size is None else size[which])

    def scaled(speed: Uncertain) -> Uncertain:
        seen = ball.length()
        return combined(speed.value / gain.value, speed.u, speed.value * gain.u, speed.value * seen.u / seen.value)

    joint, law = ball.joint, ball.law
    b, gain = ball.calibrated()
    left_open = uncalibrated(ball, response, side, lambda motion: mean_restitution(motion, ball.counted))
    u_mean = mean(ball.motion.r, use, speed).u
    r = combined(mean_restitution(ball.motion, ball.counted), u_mean, *left_open.values())
    budget: dict[str, Mapping[str, float]] = {"r": _of_r(u_mean, left_open)}
    # Of a soft impact the law says more than its own noisy ratio does.
    soft = law.at(np.where(ball.counted, speed, law.speed))

    def each(motion: BallMotion) -> Floats:
        return np.where(ball.measured, motion.r, soft)

    left_of_each = uncalibrated(ball, response, side, lambda motion: float(each(motion)[ball.counted].mean()))
    r_mean = combined(
        float(each(ball.motion)[ball.counted].mean()), mean(each(ball.motion), use).u, *left_of_each.values()
    )
    frictionless = ball_motion(ball.jumps, side, replace(joint.cavity, friction=0.0), ball.course)
    del left_open["friction"]
    # From the ratio of means to the law at the mean speed; the exponent, where it is not known, is between -.2 and 0.
    own = speed[ball.counted] / speed[ball.counted].mean()
    bent = float(np.mean(own ** (1 + law.exponent)))
    u_bent = min(law.u_exponent, 0.1) * abs(float(np.mean(own ** (1 + law.exponent) * np.log(own))))
    r_effective = combined(
        mean_restitution(frictionless, ball.counted) / bent, u_mean, r.value * u_bent, *left_open.values()
    )
    budget["r_effective"] = _of_r(u_mean, left_open) | {"correction": r.value * u_bent}
    period = 2 * np.pi / base.fit.omega
    # Momentum sees a tilt by what it adds to the jumps of a period, as little as what a sensor is off from linear.
    u_jumps = LINEARITY * float(np.mean(np.abs(fit.jumps.dv))) / (ball.weighed.value * period)
    # That counts by the share that momentum has beside what was stated.
    share = 1 - min(joint.tilt.u / stated(run.more.get("tilt"), TILT).u, 1.0) ** 2
    omega = base.fit.omega
    quantities = {
        "f": base.f,
        "E": tuning.E,
        # Known best in the middle of the record, stated for the start of the clock.
        "phase": combined(base.phase.value + tuning.phase, base.phase.u, 2 * np.pi * base.f.u * base.fit.middle),
        "omega0": tuning.omega0,
        "lam": tuning.lam,
        "Omega": combined(
            omega / tuning.omega0.value,
            omega / tuning.omega0.value * tuning.omega0.u / tuning.omega0.value,
            2 * np.pi * base.f.u / tuning.omega0.value,
        ),
        "A": combined(tuning.E.value / b.value, tuning.E.u / b.value, tuning.E.value / b.value * b.u / b.value),
        "mu": ball.weighed,
        "mu_momentum": combined(ball.alone.mu.value, ball.alone.mu.u, ball.alone.mu.value * LINEARITY),
        "b": b,
        "friction": joint.friction,
        "tilt": combined(joint.tilt.value, joint.tilt.u, share * min(u_jumps, TILT.u)),
        "r": r,
        "r_mean": r_mean,
        "r_effective": r_effective,
        "r_exponent": combined(law.exponent, law.u_exponent, *_uneven(ball, response, side).values()),
        "sigma_r": Uncertain(law.sigma_r, law.u_sigma_r),
        "impacts_per_period": mean_over_periods(
            np.array([float(len(w)) for w in periods.words]), np.arange(complete), complete
        ),
        "w_before": scaled(mean(speed, use)),
        "w_after": scaled(mean(np.abs(ball.motion.w_after), use)),
    }
    begin = (periods.cut + 2 * np.pi * (periods.first + np.arange(complete + 1)) - phase[0]) / omega + fit.jumps.t[0]
    quantities |= _energies(response, ball, begin, budget)
    found = slots(periods, pattern, phase, side)
    if found is not None:
        first = np.exp(1j * found.phase[:, 0])
        angle = float(np.angle(first.mean()))
        away = np.angle(first * np.exp(-1j * angle))
        spread = mean_over_periods(away, found.period, complete).u
        quantities["impact_phase"] = combined(
            (angle + periods.cut) % (2 * np.pi), spread, base.phase.u, omega * response.u_late
        )
        budget["impact_phase"] = {
            "scatter": spread,
            "delay": float(np.hypot(base.phase.u, omega * response.u_late)),
        }
    mu, M = ball.weighed.value, run.M
    budget["mu"] = {"mass_ball": mu * run.m.u / run.m.value, "mass_oscillator": mu * M.u / M.value}
    budget["omega0"], budget["E"], budget["b"] = tuned(tuning, "omega0"), tuned(tuning, "E"), length_parts(ball)
    A = quantities["A"].value
    budget["A"] = quotient(A, (tuning.E.value, budget["E"]), (b.value, budget["b"]))
    u_delay = float(np.hypot(base.phase.u / omega, response.u_late))
    track = Track(fit.motion, fit.jumps.t, side, ball.motion.x2, phase)
    return Reconstruction(
        run=run,
        sha256=recording.sha256,
        quantities=quantities,
        pattern=pattern,
        periods=periods,
        slots=found,
        impacts=_rows(recording, response, ball, side, phase, number),
        track=track,
        residual=fit.residual / abs(fit.motion.s) ** response.order,
        noise=fit.noise / abs(fit.motion.s) ** response.order,
        pruned=response.pruned,
        findings=(),
        base_harmonics=base.e,
        budget=budget,
        sources=source_values(run, base, ball, natural_, u_delay, LINEARITY),
    )


def _of_r(u_mean: float, left_open: Mapping[str, float]) -> dict[str, float]:
    """Return the budget of a mean restitution."""
    named = {"gain": "linearity"}
    return {"scatter": u_mean} | {named.get(cause, cause): abs(u) for cause, u in left_open.items()}


def _uneven(ball: Rebounds, response: Response, side: Floats) -> dict[str, float]:
    """Return what calibrations and the cavity leave open of the exponent: soft impacts move more than hard ones."""
    if not np.isfinite(ball.law.u_exponent):
        return {}
    weights = 1 / (ball.law.sigma_r**2 + ball.u_r[ball.measured] ** 2)

    def slope(motion: BallMotion) -> float:
        x, r = np.log(np.abs(motion.w_before[ball.measured])), motion.r[ball.measured]
        away = x - np.average(x, weights=weights)
        return float(np.sum(weights * away * r) / np.sum(weights * away**2)) / ball.law.r

    return uncalibrated(ball, response, side, slope)


def _energies(
    response: Response, ball: Rebounds, begin: Floats, budget: dict[str, Mapping[str, float]]
) -> dict[str, Uncertain]:
    """Return max|x1| a period and K2/K1; `begin` are the limits of the periods on the channel's clock.

    Both are ratios of what one sensor sees, so that its gain falls out.
    """
    motion, jumps, seen = response.fit.motion, ball.jumps, ball.length()
    times, values = motion.peaks()
    period = np.searchsorted(begin, times, side="right") - 1
    count = len(begin) - 1
    top = np.zeros(count)
    inside = (period >= 0) & (period < count)
    np.maximum.at(top, period[inside], values[inside])
    shown = top > 0
    largest = mean_over_periods(top[shown], np.flatnonzero(shown), count)
    v1 = float(motion.mean_square_velocity(jumps.t[[0, -1]])[0])
    time = np.diff(jumps.t)
    v2 = np.diff(ball.motion.x2) / time
    # Constant deceleration adds its own variance, (a dt)^2/12.
    square = v2**2 + (ball.joint.friction.value * time) ** 2 / 12
    flight = np.clip(np.searchsorted(begin, jumps.t[:-1], side="right") - 1, 0, count - 1)
    mean = float(np.average(square, weights=time))
    away = np.bincount(flight, (square - mean) * time, count) / (mean * float(np.mean(np.diff(begin))))
    of_v1 = motion.mean_square_velocity(begin)
    ratio = ball.weighed.value * mean / v1
    # v2 is that of the walls, by b, and that of the oscillator at the impacts.
    by_b = 2 * float(np.sum(v2 * (v2 - np.diff(jumps.x) / time) * time) / np.sum(square * time))
    u_ratio = ratio * standard_error(away - of_v1 / v1)
    budget["max_abs_x1"] = {
        "scatter": largest.u / seen.value, "correction": largest.value * seen.u / seen.value**2
    }  # fmt: skip
    u_mu, u_length = ball.weighed.u / ball.weighed.value, abs(by_b) * seen.u / seen.value
    budget["kinetic_ratio"] = {"scatter": u_ratio, "mass_ball": ratio * u_mu, "correction": ratio * u_length}
    return {
        "max_abs_x1": combined(
            largest.value / seen.value,
            largest.u / seen.value,
            largest.value * seen.u / seen.value**2,
        ),
        "kinetic_ratio": combined(
            ratio,
            u_ratio,
            ratio * u_mu,
            ratio * u_length,
        ),
    }


def _rows(
    recording: Recording, response: Response, ball: Rebounds, side: Floats, phase: Floats, number: npt.NDArray[np.int64]
) -> npt.NDArray[np.void]:
    jumps = ball.jumps
    rows = np.zeros(len(side), IMPACT)
    for name in ("v2", "v2_after", "w_dot", "w_dot_after", "r", "u_r"):
        rows[name] = np.nan
    rows["t"], rows["side"], rows["x1"] = jumps.t - response.late, side, jumps.x
    rows["v1"], rows["v1_after"], rows["x2"] = jumps.v_before, jumps.v_after, ball.motion.x2
    rows["u_t"] = np.hypot(response.fit.draws.t.std(axis=0), response.u_late)
    rows["phase"], rows["period"], rows["by_camera"] = np.mod(phase, 2 * np.pi), number, response.lent
    inner = slice(1, -1)
    rows["v2"][inner], rows["v2_after"][inner] = ball.motion.v2_before, ball.motion.v2_after
    rows["w_dot"][inner], rows["w_dot_after"][inner] = ball.motion.w_before, ball.motion.w_after
    rows["r"][inner], rows["u_r"][inner] = ball.motion.r, ball.u_r
    rows["suspect"][inner] = ~ball.counted
    rows["bridged"] = _bridged(recording, rows["t"])
    return rows
