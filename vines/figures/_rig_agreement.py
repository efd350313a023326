"""Measured and modelled numbers of runs beside each other, with their uncertainties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vines.figures._colours import COLOURS
from vines.figures._style import look, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["AgreementRow", "rig_agreement_figure"]


@dataclass(frozen=True, slots=True)
class AgreementRow:
    """A run: each quantity as measured and as modelled, value and standard uncertainty, and its E_n."""

    run: str
    values: Mapping[str, tuple[float, float, float, float, float]]


def rig_agreement_figure(rows: Sequence[AgreementRow], panels: Mapping[str, str], *, width: float = 7.0) -> Figure:
    """Draw a panel for each quantity: measured less modelled in units of twice both uncertainties, a row for each run.

    Parameters
    ----------
    rows : sequence of AgreementRow
        From above.
    panels : mapping of str to str
        Quantities and what their axis says.
    width : float
        Width of the figure [inch].
    """
    import matplotlib as mpl

    with mpl.rc_context(look()):
        figure = new_figure(width, 0.9 + 0.24 * max(len(rows), 3))
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for ax, (name, said) in zip(axes, panels.items(), strict=True):
            ax.axvspan(-1, 1, color="#e9efe4", linewidth=0)
            ax.axvline(0, color=COLOURS["mark"], linewidth=0.6)
            for place, row in enumerate(rows):
                if name not in row.values:
                    continue
                measured, u_measured, model, u_model, error = row.values[name]
                unit = 2 * (u_measured**2 + u_model**2) ** 0.5
                away = error if measured >= model else -error
                for u, size, colour in ((u_model, 4.0, "#b5c7dd"), (u_measured, 1.3, COLOURS["ink"])):
                    ax.plot([away - u / unit, away + u / unit], [place, place], color=colour, linewidth=size,
                            solid_capstyle="butt", zorder=2)  # fmt: skip
                ax.plot(away, place, "o", color=COLOURS["ink"] if error <= 1 else COLOURS["L"], markersize=4, zorder=3)
            ax.set_xlabel(said)
            ax.set_ylim(len(rows) - 0.5, -0.5)
            reach = max([1.5, *(1.1 * abs(row.values[name][4]) + 0.5 for row in rows if name in row.values)])
            ax.set_xlim(-reach, reach)
            ax.tick_params(axis="y", which="both", length=0)
        axes[0].set_yticks(range(len(rows)), [row.run for row in rows])
        axes[0].minorticks_off()
        return figure
