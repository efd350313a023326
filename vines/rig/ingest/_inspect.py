"""What a raw file holds, before anything is known of its sensors: rates, gaps, clipping, range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vines.errors import RigError
from vines.packages import need
from vines.rig.formats import RawChannel, RawFile
from vines.rig.ingest._clipping import flat_ends
from vines.rig.ingest._sampling import even_rate

__all__ = ["ChannelFacts", "channel_facts", "draw_file", "spark"]

_BARS = " ▁▂▃▄▅▆▇█"
_MOST_DRAWN = 8
_COLOUR = "#4477aa"
_PIECE = 0.3
"""Length of the piece from the middle [s]: some periods of a rig, in which contacts can be seen."""
_PIECE_LEAST = 16


@dataclass(frozen=True, slots=True)
class ChannelFacts:
    """What can be said of a channel from its file alone.

    Attributes
    ----------
    name : str
        As in the file.
    unit : str or None
        As written.
    rate : float or None
        Samples a second.
    samples : int
        Their number.
    least, largest, mean, rms : float
        Of the finite samples, in their unit; rms about the mean.
    gaps : str
        What is wrong with the times or where samples are missing, in words; empty if nothing is.
    clipped : int
        Samples that stay at the largest or least value for three and more, where that is no quantised top.
    """

    name: str
    unit: str | None
    rate: float | None
    samples: int
    least: float
    largest: float
    mean: float
    rms: float
    gaps: str
    clipped: int


def channel_facts(channel: RawChannel) -> ChannelFacts:
    """Look at a channel."""
    values = np.asarray(channel.values, np.float64)
    finite = np.isfinite(values)
    good = values[finite]
    said = []
    rate = channel.rate
    if channel.times is not None and channel.tick is None:
        rate = None
        said.append("its times have no unit")
    elif channel.times is not None:
        try:
            rate = even_rate(channel.times, "")
        except RigError as uneven:
            said.append(str(uneven).removeprefix(": ").split(";")[0])
    if not finite.all():
        first = channel.about.get("no number", f"number {int((~finite).argmax())}")
        said.append(f"{int((~finite).sum())} samples are no numbers, the first is {first}")
    if not len(good):
        good = np.array([np.nan])
    return ChannelFacts(
        name=channel.name,
        unit=channel.unit,
        rate=rate,
        samples=len(values),
        least=float(good.min()),
        largest=float(good.max()),
        mean=float(good.mean()),
        rms=float(np.std(good)),
        gaps="; ".join(said),
        clipped=int(flat_ends(good).sum()),
    )


def spark(channel: RawChannel, width: int = 48) -> str:
    """Return a line of bars: the largest magnitude about the mean in each part of the record.

    Examples
    --------
    >>> spark(RawChannel("a", np.array([0.0, 0.0, 1.0, -1.0, 3.0, -3.0])), width=3)
    ' ▃█'
    """
    values = np.nan_to_num(np.asarray(channel.values, np.float64))
    values = np.abs(values - values.mean())
    parts = [part.max() for part in np.array_split(values, min(width, len(values))) if len(part)]
    top = max(parts)
    if not top > 0:
        return _BARS[1] * len(parts)
    return "".join(_BARS[round(8 * float(part) / float(top))] for part in parts)


def draw_file(file: RawFile, title: str) -> Any:
    """Return a figure of a file: a row a channel, the envelope of all samples and a short piece from the middle.

    Parameters
    ----------
    file : RawFile
        What was read; at most its first eight channels are drawn.
    title : str
        Above the panels.
    """
    need("matplotlib")
    from matplotlib.figure import Figure

    shown = file.channels[:_MOST_DRAWN]
    facts = [channel_facts(each) for each in shown]
    timed = all(each.rate for each in facts)
    longest = max(each.samples / (each.rate or 1.0) for each in facts)
    figure = Figure(figsize=(7.0, 0.6 + 1.15 * len(shown)), layout="constrained")
    axes = figure.subplots(len(shown), 2, squeeze=False, sharex="col" if timed else False, width_ratios=(1.7, 1.0))
    for (whole, piece), channel, fact in zip(axes, shown, facts, strict=True):
        values, rate = np.asarray(channel.values, np.float64), fact.rate or 1.0
        parts = min(1200, max(1, len(values) // 2))
        count = len(values) // parts
        cut = values[: count * parts].reshape(parts, count)
        if count > 2:
            t = (np.arange(parts) + 0.5) * count / rate
            whole.fill_between(t, cut.min(axis=1), cut.max(axis=1), color=_COLOUR, linewidth=0.3)
        else:
            whole.plot(np.arange(len(values)) / rate, values, color=_COLOUR, linewidth=0.7)
        length = min(len(values), max(_PIECE_LEAST, round(_PIECE * rate)))
        first = (len(values) - length) // 2
        piece.plot((first + np.arange(length)) / rate, values[first : first + length], color=_COLOUR, linewidth=0.7)
        whole.set_ylabel(f"[{channel.unit}]" if channel.unit else "unit unknown")
        whole.set_title(channel.name, loc="left", fontsize="small")
        whole.set_xlim(0, longest if timed else len(values))
        for axis in (whole, piece):
            axis.spines[["top", "right"]].set_visible(False)
            axis.margins(x=0)
        piece.tick_params(labelleft=False)
        piece.sharey(whole)
    figure.align_ylabels(axes[:, 0])
    for axis in axes[-1]:
        axis.set_xlabel("time [s]" if timed else "sample")
    left = len(file.channels) - len(shown)
    figure.suptitle(title + (f" (and {left} more channels)" if left else ""), fontsize="medium")
    return figure
