"""The two drawn views: cavity and ball to scale, and the phase plane.

Lengths are those of the model (in b), and y points down as in every 2-D view of Rerun. The ball is drawn as a disc
while the model's is a point, so the ends of the cavity are drawn one radius further out: disc and wall touch exactly
when ``|w| = 1``.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from vines.viewer._called import NO_STOPS
from vines.viewer._clock import Clock
from vines.viewer._style import BALL, BASE, BESIDE, GRID, LEFT, LINE, MASS, RIGHT, SPRING, STOPPED, TRAIL

__all__ = [
    "DRIVEN",
    "PHASE_BOUNDS",
    "cavity",
    "cavity_bounds",
    "mass_beside",
    "move",
    "phase_frame",
    "phase_plane",
    "stretch_of",
    "write",
]

DRIVEN = frozenset({"impact_pair"})
"""Systems whose capsule moves as it is driven: they have neither base nor spring."""

_RADIUS = 0.09
_WALL = 0.07
_HEIGHT = 0.34
_MOUNT = 1.9
"""Where the shaken base is drawn, in b left of where the mass turns; only its displacement is to scale."""
_FLOOR = 0.62
_BESIDE = 0.5
"""Height of a mass beside the ball."""
_CAVITY_HEIGHT = (-0.85, 1.05)
"""What the view of the cavity shows in y."""
PHASE_BOUNDS = ((-1.4, 1.2), (-0.9, 1.13))
"""What the view of the phase plane shows, in the units in which w is drawn."""
_HIGHEST = 0.75
"""Height in the phase plane at which the largest ``|w'|`` of a run is drawn."""


def cavity_bounds(reach: float, longest: float = 1.0) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return what the view of a cavity shows, x and y (in b).

    Parameters
    ----------
    reach : float
        How far the mass moves.
    longest : float
        Half the length of the longest cavity, so that all are seen alike.

    Examples
    --------
    >>> cavity_bounds(1.0)
    ((-3.2, 2.4), (-0.85, 1.05))
    """
    more = longest - 1.0
    return (-_mount(reach + more) - 0.3, reach + more + 1.4), _CAVITY_HEIGHT


def _mount(reach: float) -> float:
    return reach + _MOUNT


def cavity(
    rec: rr.RecordingStream,
    root: str,
    states: dict[str, np.ndarray],
    clock: Clock,
    *,
    half: float = 1.0,
    longest: float = 1.0,
    colour: tuple[int, int, int] = BALL,
    reach: float | None = None,
    sprung: bool = True,
    walls: bool = True,
    stops: np.ndarray = NO_STOPS,
) -> None:
    """Draw the shaken base, the spring, the mass with its cavity, and the ball.

    Parameters
    ----------
    rec : rerun.RecordingStream
        Where it goes.
    root : str
        Path of the entities.
    states : dict of str to numpy.ndarray, shape (n,)
        Columns of ``vines.v1.State``, n > 0.
    clock : Clock
        Gives rows their times.
    half, longest : float
        Half the length of this cavity and of the longest one, in b.
    colour : tuple of int
        Of the ball.
    reach : float, optional
        Largest displacement of the mass; that of these states if left out.
    sprung : bool
        Whether there are base and spring; else the mass moves as it is driven.
    walls : bool
        Whether there are walls.
    stops : numpy.ndarray, shape (n, 2)
        Begin and end of spells in which the ball stops in mid-cavity; it is grey then.
    """
    x1, x2, base = states["x1"], states["x2"], states["base"]
    mount = -_mount((float(np.abs(x1).max()) if reach is None else reach) + (longest - 1.0))
    indexes = clock.columns(states["t"])
    inner = half + _RADIUS
    outer = inner + 2 * _WALL
    for name, sign, of_wall in (("left", -1, LEFT), ("right", 1, RIGHT)) if walls else ():
        x = sign * (inner + _WALL)
        rec.log(
            f"{root}/mass/{name}",
            rr.LineStrips2D([[(x, -_HEIGHT + _WALL), (x, _HEIGHT - _WALL)]], radii=_WALL, colors=of_wall),
            static=True,
        )
    shell = [[(-outer, y), (outer, y)] for y in (-_HEIGHT - 0.04, _HEIGHT + 0.04)]
    rec.log(f"{root}/mass/shell", rr.LineStrips2D(shell, radii=0.04, colors=MASS), static=True)
    if walls:
        write(rec, f"{root}/mass/names", [(-inner - _WALL, -0.64), (inner + _WALL, -0.64)], ["L", "R"])
    move(rec, f"{root}/mass", indexes, x1)

    rec.log(f"{root}/ball", rr.Points2D([(0.0, 0.0)], radii=_RADIUS, draw_order=40.0), static=True)
    if len(stops):
        # What is static would be drawn at all times.
        times = np.concatenate([states["t"][:1], stops.ravel()])
        turns = np.array([colour, *[STOPPED, colour] * len(stops)], dtype=np.uint8)
        rec.send_columns(f"{root}/ball", indexes=clock.columns(times), columns=rr.Points2D.columns(colors=turns))
    else:
        rec.log(f"{root}/ball", rr.Points2D.from_fields(colors=colour), static=True)
    move(rec, f"{root}/ball", indexes, x2)

    if sprung:
        wall = [[(0.0, -_HEIGHT - 0.1), (0.0, _HEIGHT + 0.1)]]
        rec.log(f"{root}/base", rr.LineStrips2D(wall, radii=0.05, colors=BASE), static=True)
        move(rec, f"{root}/base", indexes, mount + base)

        _coil(rec, f"{root}/spring", 0.14)
        length = x1 - outer - (mount + base)
        move(rec, f"{root}/spring", indexes, mount + base, scale=length)

    reach = max(2.0, float(np.ceil(np.abs(np.concatenate([x1, x2])).max())))
    ticks = np.arange(-reach, reach + 0.5)
    strips = [[(-reach, _FLOOR), (reach, _FLOOR)], *([(x, _FLOOR), (x, _FLOOR + 0.06)] for x in ticks)]
    rec.log(f"{root}/ruler", rr.LineStrips2D(strips, radii=rr.Radius.ui_points(0.8), colors=GRID), static=True)
    write(rec, f"{root}/ruler/scale", [(x, _FLOOR + 0.2) for x in ticks], [f"{x:g}" for x in ticks])


def _coil(rec: rr.RecordingStream, path: str, sway: float, colour: tuple[int, int, int] = SPRING) -> None:
    """Draw a spring of length 1 that sways so far to either side."""
    along = np.concatenate([[0.0, 0.12], np.linspace(0.16, 0.84, 13), [0.88, 1.0]])
    across = np.concatenate([[0.0, 0.0], sway * (-1.0) ** np.arange(13), [0.0, 0.0]])
    coil = np.column_stack([along, across])
    rec.log(path, rr.LineStrips2D([coil], radii=rr.Radius.ui_points(1.2), colors=colour), static=True)


def mass_beside(rec: rr.RecordingStream, root: str, states: dict[str, np.ndarray], clock: Clock) -> None:
    """Draw the mass on a spring beside the ball, under the cavity: at x3, on a spring from the middle of the cavity.

    Parameters are those of `cavity`; `states` have the columns of ``vines.v1.Nes`` too.
    """
    indexes = clock.columns(states["t"])
    _coil(rec, f"{root}/spring_beside", 0.05, BESIDE)
    move(rec, f"{root}/spring_beside", indexes, states["x1"], _BESIDE, scale=-states["u"])
    side = 0.08
    square = [[(-side, -side), (side, -side), (side, side), (-side, side), (-side, -side)]]
    rec.log(f"{root}/mass_beside", rr.LineStrips2D(square, radii=0.03, colors=BESIDE, draw_order=40.0), static=True)
    move(rec, f"{root}/mass_beside", indexes, states["x3"], _BESIDE)


def phase_plane(
    rec: rr.RecordingStream,
    root: str,
    states: dict[str, np.ndarray],
    impacts: dict[str, np.ndarray],
    clock: Clock,
    parts: tuple[slice, ...],
    *,
    widest: float = 1.0,
    walls: bool = True,
    stops: np.ndarray = NO_STOPS,
) -> None:
    """Draw the orbit in the plane of w and w', its recent part as a trail, where it is now, and its impacts.

    Parameters are those of `vines.viewer._scene.cavity`; `impacts` has the columns of ``vines.v1.Impact``, and `parts`
    are the states between which none was left out: only these are joined by lines. `widest` is the largest |w| shown.
    """
    indexes = clock.columns(states["t"])
    path = np.column_stack([states["w"], states["w_dot"]])
    after = impacts["v1_after"] - impacts["v2_after"]
    fastest = float(np.abs(np.concatenate([states["w_dot"], impacts["w_dot"], after])).max()) or 1.0
    stretch = widest * stretch_of(fastest)
    # Beneath the origin of the view, whose own transform would not show.
    root = f"{root}/plane"
    rec.log(root, rr.Transform3D(scale=[1.0, -stretch, 1.0]), static=True)
    rec.log(
        f"{root}/orbit",
        rr.LineStrips2D([path[part] for part in parts], radii=rr.Radius.ui_points(1.0), colors=LINE, draw_order=10.0),
        static=True,
    )

    joined = np.concatenate([np.arange(len(path))[part] for part in parts])
    pieces = np.stack([path[np.maximum(joined - 1, 0)], path[joined]], axis=1)
    trail = rr.LineStrips2D.columns(strips=pieces.astype(np.float32))
    rec.log(
        f"{root}/trail",
        rr.LineStrips2D.from_fields(radii=rr.Radius.ui_points(2.2), colors=TRAIL, draw_order=20.0),
        static=True,
    )
    rec.send_columns(f"{root}/trail", indexes=clock.columns(states["t"][joined]), columns=trail)
    rec.log(
        f"{root}/now",
        rr.Points2D([(0.0, 0.0)], radii=rr.Radius.ui_points(6.0), colors=BALL, draw_order=40.0),
        static=True,
    )
    move(rec, f"{root}/now", indexes, path[:, 0], path[:, 1])

    for name, side, colour in (("left", 1, LEFT), ("right", -1, RIGHT)):
        hits = impacts["side"] == side
        marks = np.column_stack([np.full(hits.sum(), float(side)), impacts["w_dot"][hits]])
        leaves = np.column_stack([np.full(hits.sum(), float(side)), after[hits]])
        if len(marks):
            size = rr.Radius.ui_points(4.5)
            rec.log(
                f"{root}/impacts/{name}",
                rr.Points2D(np.concatenate([marks, leaves]), radii=size, colors=colour, draw_order=30.0),
                static=True,
            )
    if len(stops):
        held = np.interp(stops[:, 0], states["t"], states["w"])
        marks = rr.Points2D(
            np.column_stack([held, np.zeros_like(held)]),
            radii=rr.Radius.ui_points(4.5),
            colors=STOPPED,
            draw_order=30.0,
        )
        rec.log(f"{root}/stops", marks, static=True)
    phase_frame(rec, root, fastest, widest=widest, walls=walls)


def stretch_of(fastest: float) -> float:
    """Return by how much ``w'`` is stretched in a phase plane in which ``|w'|`` goes up to `fastest`."""
    return _HIGHEST / fastest


def phase_frame(
    rec: rr.RecordingStream,
    root: str,
    fastest: float,
    across: str = "w",
    *,
    widest: float = 1.0,
    walls: bool = True,
) -> None:
    """Draw walls, axes and numbers of a phase plane of `across` and ``w'`` in which ``|w'|`` goes up to `fastest`."""
    thin = rr.Radius.ui_points(0.8)
    top = fastest * 1.12
    frame = [
        [(-1.0, -top), (-1.0, top)],
        [(1.0, -top), (1.0, top)],
        [(-widest, 0.0), (widest, 0.0)],
        [(0.0, -top), (0.0, top)],
    ]
    rec.log(
        f"{root}/frame",
        rr.LineStrips2D(
            frame, radii=thin, colors=[*((RIGHT, LEFT) if walls else (GRID, GRID)), GRID, GRID], draw_order=1.0
        ),
        static=True,
    )
    step = _step(fastest)
    marks = np.arange(-np.floor(fastest / step), np.floor(fastest / step) + 0.5) * step
    write(rec, f"{root}/frame/w_dot", [(-1.18 * widest, v) for v in marks], [f"{v:.3g}" for v in marks])
    write(
        rec,
        f"{root}/frame/w",
        [(x, -top * 1.13) for x in (-1.0, 0.0, 1.0)],
        [f"R  {across} = −1", "0", f"L  {across} = +1"] if walls else ["−1", "0", "+1"],
    )


def move(
    rec: rr.RecordingStream,
    path: str,
    indexes: list[rr.TimeColumn],
    x: np.ndarray,
    y: np.ndarray | float = 0.0,
    *,
    scale: np.ndarray | None = None,
) -> None:
    """Move what is drawn at a path; ``scale`` stretches it in x."""
    zero = np.zeros_like(x)
    at = np.column_stack([x, zero + y, zero])
    if scale is None:
        columns = rr.Transform3D.columns(translation=at)
    else:
        columns = rr.Transform3D.columns(translation=at, scale=np.column_stack([scale, zero + 1.0, zero + 1.0]))
    rec.send_columns(path, indexes=indexes, columns=columns)


def write(rec: rr.RecordingStream, path: str, places: list[tuple[float, float]], texts: list[str]) -> None:
    """Write labels without marks."""
    rec.log(
        path,
        rr.Points2D(places, radii=0.0, labels=texts, show_labels=True, colors=MASS, draw_order=50.0),
        static=True,
    )


def _step(reach: float) -> float:
    """Return a round step that divides ``reach`` into two to five.

    Examples
    --------
    >>> _step(1.3), _step(0.04)
    (0.5, 0.01)
    """
    base = 10.0 ** np.floor(np.log10(reach))
    return float(next(base * k for k in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0) if reach / (base * k) <= 5.0))
