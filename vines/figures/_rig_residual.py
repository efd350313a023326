"""What the fit of each run leaves, over its temperature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from vines.figures._axes import SHOWN, name_axis
from vines.figures._colours import COLOURS
from vines.figures._legend import Entry, add_legend
from vines.figures._rig_branches import DIRECTIONS, rig_mark
from vines.figures._style import font, look, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["rig_residual_figure"]

Floats = npt.NDArray[np.float64]


def rig_residual_figure(
    temperature: Floats,
    residual: Floats,
    noise: Floats,
    protocol: Sequence[str],
    accepted: npt.NDArray[np.bool_],
    *,
    caption: str = "",
    width: float = 5.0,
) -> Figure:
    """Draw the residual of each run's fit and the noise of its channel over the temperature.

    A drift of the residual with temperature says that the oscillator is not the one of the ring-downs.

    Parameters
    ----------
    temperature : (n,) array
        [deg C].
    residual, noise : (n,) array
        Root mean square, of block means [m].
    protocol : sequence of str
        Keys of :data:`DIRECTIONS`.
    accepted : (n,) array of bool
        Whether the run passes every gate and check.
    caption : str
        Written above.
    width : float
        Width of the figure [inch].
    """
    import matplotlib as mpl
    from matplotlib.lines import Line2D

    ink, kinds = COLOURS["ink"], np.array(protocol)
    with mpl.rc_context(look()):
        figure = new_figure(width, 3.4)
        ax = figure.subplots()
        ax.plot(temperature, 1e6 * noise, zorder=2, **_noise())
        for name in DIRECTIONS:
            for good in (True, False):
                at = (kinds == name) & (accepted == good)
                ax.plot(temperature[at], 1e6 * residual[at], zorder=3, **rig_mark(name, ink, good=good))
        name_axis(ax, "x", "temperature", SHOWN["temperature"])
        name_axis(ax, "y", "residual", SHOWN["residual"])
        ax.set_ylim(0, 1.25 * 1e6 * float(max(residual.max(initial=0.0), noise.max(initial=0.0), 1e-9)))
        ax.set_title(caption, fontsize=font(8.5), loc="left", pad=6)
        entries: list[Entry] = [
            (word, (Line2D([], [], **rig_mark(name, ink, good=True)),))
            for name, word in (
                ("sweep_up", "amplitude rising"),
                ("sweep_down", "amplitude falling"),
                ("dwell", "dwell"),
            )
            if (kinds == name).any()
        ]
        if not accepted.all():
            entries.append(("empty: gates failed", (Line2D([], [], **rig_mark("dwell", ink, good=False)),)))
        entries.append(("noise of the channel", (Line2D([], [], **_noise()),)))
        add_legend(figure, entries)
    return figure


def _noise() -> dict[str, Any]:
    return {"linestyle": "none", "marker": "_", "markersize": 9, "markeredgecolor": COLOURS["mark"]}
