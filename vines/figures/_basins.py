"""Basins of attraction as a map of the starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["BasinMap", "basins_figure"]

SYMBOLS = {"x1": "$x_1$", "v1": "$x_1'$", "x2": "$x_2$", "v2": "$x_2'$", "phase": r"phase $\phi$"}
HUES = ("#2166ac", "#e08214", "#1b7837", "#762a83", "#b2182b", "#888888")


@dataclass(frozen=True, slots=True)
class BasinMap:
    """Cells of a map: centres, halvings, attractor (-1 unsettled) and whether its mirror image was reached.

    `names` describe the attractors, with their shares; `steps` are the sizes of an uncut cell.
    """

    axes: tuple[str, str]
    x: np.ndarray
    y: np.ndarray
    level: np.ndarray
    attractor: np.ndarray
    mirrored: np.ndarray
    names: Sequence[str]
    steps: tuple[float, float]


def basins_figure(data: BasinMap, *, title: str = "", width: float = 7.0) -> Figure:
    """Draw the map: one hue for each attractor, darker where its mirror image is reached.

    Parameters
    ----------
    data : BasinMap
        The cells.
    title : str
        Above the picture.
    width : float
        In inches.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    figure = Figure(figsize=(width, 0.78 * width), layout="constrained")
    ax = figure.add_subplot()
    colours = np.array([to_rgb(HUES[k % len(HUES)]) for k in range(len(data.names))] + [(1.0, 1.0, 1.0)])
    shown = colours[np.where(data.attractor < 0, len(colours) - 1, data.attractor)]
    shown = np.where(data.mirrored[:, None], 0.62 * shown, shown)
    half = 0.5 * np.array(data.steps) / 2.0 ** data.level[:, None]
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    centres = np.stack([data.x, data.y], axis=1)
    quads = centres[:, None, :] + corners[None, :, :] * half[:, None, :]
    cells = PolyCollection(list(quads), facecolors=shown, edgecolors="none", antialiased=False, rasterized=True)
    ax.add_collection(cells)
    ax.set_xlim(quads[..., 0].min(), quads[..., 0].max())
    ax.set_ylim(quads[..., 1].min(), quads[..., 1].max())
    ax.set_xlabel(f"{SYMBOLS[data.axes[0]]} at the start")
    ax.set_ylabel(f"{SYMBOLS[data.axes[1]]} at the start")
    handles = [Patch(color=colours[k], label=name) for k, name in enumerate(data.names)]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(3, len(handles)), frameon=False)
    ax.set_title(title)
    return figure
