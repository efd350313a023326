"""The curves over time: ends and ball, w, w', the energies and their running balance."""

from __future__ import annotations

import numpy as np
import rerun as rr

from vines.model import VI_NES
from vines.viewer._called import NO_STOPS, Called
from vines.viewer._clock import Clock
from vines.viewer._impacts import bars_of
from vines.viewer._style import BALL, BASE, BESIDE, DAMPER, IMPACTS, LEFT, LINE, MASS, RIGHT, SPRING, STOPPED, STORED

__all__ = ["balance", "balance_of", "curves", "lines", "running"]

_Colour = tuple[int, int, int]
_ENERGIES = VI_NES.energies


def balance(states: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the running energy balance since the first state.

    Parameters
    ----------
    states : dict of str to numpy.ndarray, shape (n,)
        Columns of ``vines.v1.State``, n > 0.

    Returns
    -------
    dict of str to numpy.ndarray, shape (n,)
        In M b² omega0², each 0 at first: ``base_work``, ``damper_loss``, ``impact_loss`` and ``stored`` (change of
        kinetic and potential energy); base_work = damper_loss + impact_loss + stored but for rounding.
    """
    return balance_of(states, _stored(states))


def balance_of(states: dict[str, np.ndarray], stored: np.ndarray) -> dict[str, np.ndarray]:
    """Return the running energy balance where `stored`, shape (n,), is what is stored."""
    since = {name: states[name] - states[name][0] for name in (*_ENERGIES.gained, *_ENERGIES.lost)}
    return {**since, "stored": stored - stored[0]}


def _stored(states: dict[str, np.ndarray]) -> np.ndarray:
    beside = [name for name in ("kinetic_3",) if name in states]
    return np.sum([states[name] for name in (*_ENERGIES.stored, *beside)], axis=0)


def curves(
    rec: rr.RecordingStream,
    root: str,
    states: dict[str, np.ndarray],
    impacts: dict[str, np.ndarray],
    clock: Clock,
    *,
    sprung: bool = True,
    names: Called | None = None,
    stops: np.ndarray = NO_STOPS,
    modal: bool = False,
) -> None:
    """Send all curves and the marks of the impacts on them.

    Parameters are those of `vines.viewer._scene.cavity`; `impacts` has the columns of ``vines.v1.Impact``, and with
    `modal` energies of the frame are those of its modes.
    """
    names = names or Called()
    x1, x2 = states["x1"], states["x2"]
    indexes = clock.columns(states["t"])
    # The LEFT end is at x1 - 1: there x2 = x1 - 1, so w = x1 - x2 = +1.
    ends: list[tuple[str, np.ndarray, _Colour]] = [
        (f"right {names.wall}, x1 + 1", x1 + 1.0, RIGHT),
        (f"{names.body}, x2", x2, BALL),
        (f"left {names.wall}, x1 − 1", x1 - 1.0, LEFT),
    ]
    if not names.walls:
        ends = [(f"{names.frame}, x1", x1, LINE), ends[1]]
    if "x3" in states:
        ends.append(("mass on the spring, x3", states["x3"], BESIDE))
    lines(rec, f"{root}/ends", ends, indexes)
    lines(rec, f"{root}/w/gap", [("w", states["w"], LINE)], indexes)
    lines(rec, f"{root}/w_dot/rate", [("w'", states["w_dot"], LINE)], indexes)
    energies: list[tuple[str, np.ndarray, _Colour]] = [
        ("total", _stored(states), MASS),
        (f"{names.frame}, v1²/2", states["kinetic_1"], LINE),
        (names.stored, states["potential"], SPRING),
        (f"{names.body}, µ v2²/2", states["kinetic_2"], BALL),
    ]
    if modal:
        energies[1] = ("modes, Σ q'²/2", states["kinetic_1"], LINE)
        energies[2] = ("springs, Σ ω²(q − γ e)²/2", states["potential"], SPRING)
    if "x3" in states:
        of_frame = states["potential"] - states["spring"]
        energies[2] = ("spring, (x1 − e)²/2", of_frame, SPRING)
        energies.append(("mass on the spring, with it", states["kinetic_3"] + states["spring"], BESIDE))
    if not sprung:  # a capsule that is driven stores nothing
        weight = ("ball, G x2", states["potential"], SPRING)
        energies = [energies[0], weight, ("ball, v2²/2", states["kinetic_2"], BALL)]
    lines(rec, f"{root}/energy", energies, indexes)
    running(rec, root, balance(states), indexes, names.lost)
    if len(stops):
        held = np.interp(stops[:, 0], states["t"], states["w"])
        for part, height in (("w", held), ("w_dot", np.zeros_like(held))):
            path = f"{root}/{part}/stopped"
            rec.log(path, rr.SeriesLines(colors=STOPPED, widths=5.0, names="stop in mid-cavity"), static=True)
            times, bars = bars_of(stops, height)
            rec.send_columns(path, indexes=clock.columns(times), columns=rr.Scalars.columns(scalars=bars))

    for name, side, colour in (("left", 1, LEFT), ("right", -1, RIGHT)):
        hits = impacts["side"] == side
        if not hits.any():
            continue
        times = clock.columns(impacts["t"][hits])
        for path, values in (
            ("ends", impacts["x2"]),
            ("w", np.asarray(impacts["side"], float)),
            ("w_dot", impacts["w_dot"]),
        ):
            marks = f"{root}/{path}/{name}"
            style = rr.SeriesPoints(
                colors=colour, markers="circle", marker_sizes=4.0, names=f"impact {name[0].upper()}"
            )
            rec.log(marks, style, static=True)
            rec.send_columns(marks, indexes=times, columns=rr.Scalars.columns(scalars=values[hits]))


def running(
    rec: rr.RecordingStream,
    root: str,
    parts: dict[str, np.ndarray],
    indexes: list[rr.TimeColumn],
    lost: str = Called.lost,
) -> None:
    """Send the curves of the running balance; `lost` says what that of the damper holds."""
    series: list[tuple[str, np.ndarray, _Colour]] = [
        ("work of the base", parts["base_work"], BASE),
        (lost, parts["damper_loss"], DAMPER),
        ("lost in impacts", parts["impact_loss"], IMPACTS),
        ("stored", parts["stored"], STORED),
    ]
    lines(rec, f"{root}/balance", series, indexes)


def lines(
    rec: rr.RecordingStream,
    path: str,
    series: list[tuple[str, np.ndarray, _Colour]],
    indexes: list[rr.TimeColumn],
) -> None:
    """Send several curves as one entity, which is the smaller and faster form."""
    names, values, colours = zip(*series, strict=True)
    style = rr.SeriesLines(colors=list(colours), widths=[1.6] * len(series), names=list(names))
    rec.log(path, style, static=True)
    every = np.column_stack(values)
    columns = rr.Scalars.columns(scalars=every.ravel()).partition(np.full(len(every), len(series)))
    rec.send_columns(path, indexes=indexes, columns=columns)
