"""What is known of a run while it goes on, in words: a line, or a page."""

from __future__ import annotations

from vines.rig.watch import Report, Stream

__all__ = ["report_line", "status_text"]


def report_line(report: Report) -> str:
    """Return a report as one line.

    Examples
    --------
    >>> from vines.rig.watch import Report
    >>> blank = dict.fromkeys(("E", "f", "u_f", "response", "max_abs_x1", "rate", "share", "r", "wait"))
    >>> report_line(Report(
    ...     t=75.0, lost=0, levels={}, impacts=0, pattern="", periods=0, phases={}, settled=False,
    ...     why="the base does not move", since=0.0, drift={}, remarks=[], **blank))
    '1:15  0 impacts  not settled: the base does not move'
    """
    minutes, rest = divmod(report.t, 60)
    parts = [f"{minutes:.0f}:{rest:02.0f}"]
    if report.E is not None and report.f is not None:
        parts += [f"E {1e3 * report.E:.4f} mm", f"f {report.f:.4f} Hz"]
    if report.max_abs_x1 is not None:
        parts.append(f"|x1| {1e3 * report.max_abs_x1:.2f} mm")
    if report.pattern and report.share is not None:
        parts.append(f"{report.pattern} {report.share:.0%} of {report.periods}")
    else:
        parts.append(f"{report.impacts} impacts")
    if report.r is not None:
        parts.append(f"r {report.r:.3f}")
    parts.append(_rest(report))
    parts += [f"{name} {text}" for name, text in drifts(report).items()]
    return "  ".join([*parts, *(f"! {remark}" for remark in report.remarks)])


def drifts(report: Report) -> dict[str, str]:
    """Return what drifts, in words."""
    found = {}
    for name, rate in report.drift.items():
        found[name] = {"f": f"{1e6 * rate:+.0f} ppm/min", "r": f"{rate:+.3f}/min"}.get(name, f"{100 * rate:+.1f} %/min")
    return found


def _rest(report: Report) -> str:
    if report.settled:
        return f"settled ({report.why})" if report.why else "settled"
    wait = f", about {report.wait:.0f} s more" if report.wait else ""
    return f"not settled{wait}: {report.why}"


def status_text(report: Report, stream: Stream) -> str:
    """Return a report at length, as Markdown."""
    state = "settled" if report.settled else (f"wait about {report.wait:.0f} s" if report.wait else "not settled")
    lines = [f"## {stream.name}: {state}", "", report.why or "Nothing goes one way.", "", "| | |", "|---|---|"]

    def row(name: str, text: str | None) -> None:
        if text is not None:
            lines.append(f"| {name} | {text} |")

    row("base E", None if report.E is None else f"{1e3 * report.E:.5f} mm")
    row("frequency", None if report.f is None else f"{report.f:.5f} Hz")
    row("largest abs x1", None if report.max_abs_x1 is None else f"{1e3 * report.max_abs_x1:.3f} mm")
    row(
        "pattern",
        f"{report.pattern}, {report.share:.0%} of {report.periods} periods" if report.share is not None else None,
    )
    row("impacts", f"{report.impacts}" + (f", {report.rate:.2f} a period" if report.rate is not None else ""))
    row("restitution r", None if report.r is None else f"{report.r:.3f}")
    for name, text in drifts(report).items():
        row(f"drift of {name}", text)
    row("lost samples", f"{report.lost}")
    lines += ["", "| channel | rms | peak | range used | clipped |", "|---|---|---|---|---|"]
    for name, level in report.levels.items():
        used = "" if level.full is None else f"{level.full:.0%}"
        scale, unit = (1e3, "mm") if level.unit == "m" else (1.0, level.unit)
        sizes = " | ".join(f"{scale * size:.3g} {unit}" for size in (level.rms, level.peak))
        lines.append(f"| {name} | {sizes} | {used} | {level.clipped_since} |")
    lines += ["", *(f"**{remark}**  " for remark in report.remarks)]
    return "\n".join(lines)
