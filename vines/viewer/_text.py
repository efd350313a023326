"""What the viewer says in words: the impacts as a log, and a run's parameters and origin."""

from __future__ import annotations

import numpy as np
import rerun as rr

from vines.logs import Log
from vines.model import VI_NES
from vines.viewer._called import called, stops_of
from vines.viewer._clock import Clock
from vines.viewer._style import BALLS, LEFT, RIGHT

__all__ = ["about", "impact_lines", "send_impact_log"]

_EMPTY = ("", "null", "{}", "[]")
"""Provenance that says nothing, as text and as JSON."""
_MEANINGS = {each.name: each.label for each in VI_NES.parameters}


def impact_lines(impacts: dict[str, np.ndarray]) -> list[str]:
    """Return one line an impact: its time, the rate of the gap before and after, the phase of the forcing.

    Parameters
    ----------
    impacts : dict of str to numpy.ndarray, shape (n,)
        Columns of ``vines.v1.Impact``.
    """
    after = impacts["v1_after"] - impacts["v2_after"]
    return [
        f"t {t:.4f}   w' {before:+.4f} → {left:+.4f}   phase {phase / np.pi:.3f}π"
        for t, before, left, phase in zip(impacts["t"], impacts["w_dot"], after, impacts["phase"], strict=True)
    ]


def send_impact_log(rec: rr.RecordingStream, path: str, impacts: dict[str, np.ndarray], clock: Clock) -> None:
    """Send the impacts as a text log, L in red and R in blue, of several balls in their colours.

    Nothing is sent where there is none.
    """
    if not len(impacts["t"]):
        return
    colours = np.where((impacts["side"] == 1)[:, None], LEFT, RIGHT)
    letters = list(VI_NES.letters(impacts["side"]))
    if "ball" in impacts:
        colours = np.array(BALLS)[impacts["ball"] - 1]
        letters = [f"{letter}{ball}" for letter, ball in zip(letters, impacts["ball"], strict=True)]
    columns = rr.TextLog.columns(text=impact_lines(impacts), level=letters, color=colours.astype(np.uint8))
    rec.send_columns(path, indexes=clock.columns(impacts["t"]), columns=columns)


def about(log: Log, left_out: str = "") -> str:
    """Return a run's parameters, counts, provenance and what is left out of its picture, as Markdown."""
    rows = [(_named(name), f"{value:.10g}") for name, value in log.parameters.items()]
    if log.word:
        rows.append(("word", log.word))
    for orbit in log.orbits.to_pylist():
        size = np.hypot(orbit["multiplier_1_re"], orbit["multiplier_1_im"])
        rows.append(("orbit", "stable" if orbit["stable"] else "unstable"))
        rows.append(("largest multiplier", f"{size:.6g}"))
        rows.append(("period", f"{orbit['period']:.8g}"))
    if log.states.num_rows:
        rows += _counts(log)
    for name, samples in log.sensors.items():
        rows.append((name, f"{samples.num_rows} samples"))
    if log.recovered:
        rows.append(("**recovered**, lost", _short(log.recovered.get("lost", ""), 80)))
    rows += [(name, _short(text)) for name, text in log.provenance.items() if text not in _EMPTY]
    more = ["", f"*{left_out}*"] if left_out else []
    return "\n".join(
        [f"### {log.name}", *more, "", "| | |", "|---|---|", *(f"| {name} | {text} |" for name, text in rows)]
    )


def _counts(log: Log) -> list[tuple[str, str]]:
    sides = log.impacts["side"].to_numpy()
    times = log.states["t"].to_numpy()
    rows = [("time t", f"{times[0]:.6g} to {times[-1]:.6g}")]
    if "Omega" in log.parameters:
        rows.append(("forcing cycles", f"{(times[-1] - times[0]) * log.parameters['Omega'] / (2 * np.pi):.4g}"))
    rows.append(("impacts on L and R", f"{(sides == 1).sum()} and {(sides == -1).sum()}"))
    for ball in log.balls:
        own = sides[log.impacts["ball"].to_numpy() == ball]
        rows.append((f"those of ball {ball}", f"{(own == 1).sum()} and {(own == -1).sum()}"))
    stops = len(stops_of(log))
    rows.append(("sticks", str(log.sticks.num_rows - stops)))
    if called(log).stops:
        rows.append(("stops in mid-cavity", str(stops)))
    return rows


def _named(symbol: str) -> str:
    """Return a parameter's symbol with what it means.

    Examples
    --------
    >>> _named("mu")
    'mu, mass ratio'
    >>> _named("mu_2")
    'mu_2, mass ratio'
    """
    base, _, number = symbol.rpartition("_")
    meant = base if number.isdecimal() else symbol
    return f"{symbol}, {_MEANINGS[meant]}" if meant in _MEANINGS else symbol


def _short(text: str, most: int = 24) -> str:
    """Return text that fits a cell of the table."""
    flat = " ".join(text.split()).replace("|", "\\|")
    return flat if len(flat) <= most else flat[: most - 1] + "…"
