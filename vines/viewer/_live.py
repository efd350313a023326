"""A run in the viewer while it goes on: what is measured, what is found, and what of it is said."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import TimelineColumn

from vines.errors import FileMissingError, ViewerError
from vines.viewer._program import listening
from vines.viewer._save import replacing
from vines.viewer._style import BALL, BASE, LEFT, LINE, PARAMETERS, RIGHT

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

    from vines.logs import Log

__all__ = ["Live", "live"]

RUN_TIME = "run_time"
"""Timeline of the seconds since the run began."""
_WINDOW = 1.5
"""Seconds of a curve that are shown."""
_APPLICATION = "vines live"
_PAUSE, _SETTLES = 0.4, 20.0
_SERIES = {
    "response": ("largest |x1| [mm]", LINE),
    "share": ("periods with the pattern", BALL),
    "r": ("restitution r", BASE),
}
"""By the name under which a value is sent: what it is, and its colour."""


class Live:
    """What shows a run while it goes on.

    Parameters
    ----------
    send : callable
        ``send(recording, blueprint)`` connects a recording to what shows it.
    client : callable, optional
        Connects to the viewer, where it can be asked for a picture.
    alive : callable
        Says whether what shows it is still there.
    """

    def __init__(
        self,
        send: Callable[[rr.RecordingStream, rrb.Blueprint], object],
        client: Callable[[], ViewerClient] | None = None,
        alive: Callable[[], bool] = lambda: True,
    ):
        self._send, self._client, self._alive = send, client, alive
        self._rec: rr.RecordingStream | None = None
        self._paths: dict[str, str] = {}

    @property
    def alive(self) -> bool:
        """Whether what shows it is still there: a window may have been closed."""
        return self._alive()

    def show(self, log: Log) -> None:
        """Show a run of the simulator, whole and playing; what was shown before stays in the list of recordings.

        Raises
        ------
        ViewerError
            If the log has no state.
        """
        from vines.viewer._recording import send_run

        send_run(log, self.recording)

    def begin(self, name: str, sensors: Mapping[str, str], about: str = "") -> None:
        """Begin a recording.

        Parameters
        ----------
        name : str
            What the run is called.
        sensors : mapping of str to str
            Of each channel, what its values are; the order is that of the views.
        about : str
            What is known of a run of which nothing but samples is shown, as Markdown.
        """
        self._paths = {sensor: f"/sensors/{place}" for place, sensor in enumerate(sensors)}
        rec = self.recording(name, _layout(sensors, self._paths, alone=bool(about)))
        for sensor, label in sensors.items():
            colour = BASE if sensor.startswith("base") else LINE
            # A mean over the samples of a pixel would hide shocks.
            style = rr.SeriesLines(colors=colour, widths=1.2, names=label, aggregation_policy="MinMax")
            rec.log(self._paths[sensor], style, static=True)
        for letter, colour in (("L", LEFT), ("R", RIGHT)):
            style = rr.SeriesPoints(colors=colour, markers="circle", marker_sizes=3.0, names=f"impact {letter}")
            rec.log(f"/phase/{letter}", style, static=True)
        for key, (label, colour) in _SERIES.items():
            style = rr.SeriesLines(colors=colour, widths=2.0, names=label)
            rec.log(f"/found/{key}", style, static=True)
        if about:
            rec.log("/status", rr.TextDocument(about, media_type=rr.MediaType.MARKDOWN), static=True)

    def recording(self, name: str, layout: rrb.Blueprint) -> rr.RecordingStream:
        """Begin a recording that is called so, and return it; the one before ends."""
        self.end()
        self._rec = rec = rr.RecordingStream(_APPLICATION, send_properties=False)
        self._send(rec, layout)
        rec.send_recording_name(name)
        return rec

    def samples(self, sensor: str, t: np.ndarray, values: np.ndarray) -> None:
        """Add samples of a channel, times in seconds, shape (n,)."""
        if self._rec is not None and len(t) and sensor in self._paths:
            columns = rr.Scalars.columns(scalars=values)
            self._rec.send_columns(self._paths[sensor], indexes=[rr.TimeColumn(RUN_TIME, duration=t)], columns=columns)

    def impacts(self, t: np.ndarray, side: np.ndarray, phase: np.ndarray) -> None:
        """Add impacts: times [s], sides (+1 L, -1 R), phases of the base [rad], shape (n,)."""
        if self._rec is None:
            return
        for letter, sign in (("L", 1), ("R", -1)):
            here = (side == sign) & np.isfinite(phase)
            if here.any():
                columns = rr.Scalars.columns(scalars=np.degrees(phase[here]))
                times = [rr.TimeColumn(RUN_TIME, duration=t[here])]
                self._rec.send_columns(f"/phase/{letter}", indexes=times, columns=columns)

    def status(self, t: float, markdown: str, line: str, found: Mapping[str, float]) -> None:
        """Say how the run goes at a time [s].

        Parameters
        ----------
        t : float
            The time.
        markdown, line : str
            At length, and in a line of the log.
        found : mapping of str to float
            Values of ``response``, ``share`` and ``r``, those that are known.
        """
        if self._rec is None:
            return
        self._rec.set_time(RUN_TIME, duration=t)
        self._rec.log("/status", rr.TextDocument(markdown, media_type=rr.MediaType.MARKDOWN))
        self._rec.log("/lines", rr.TextLog(line))
        for key, value in found.items():
            if key in _SERIES:
                self._rec.log(f"/found/{key}", rr.Scalars(value))
        self._rec.flush()

    def picture(self, out: Path) -> None:
        """Draw what is shown now to a PNG file; an existing one is replaced.

        Raises
        ------
        FileMissingError
            If the folder of `out` does not exist.
        ViewerError
            If it is not shown without a window, or does not come to rest.
        """
        if self._client is None:
            raise ViewerError("a picture of a run that goes on is drawn without a window only")
        if self._rec is not None:
            self._rec.flush()
        viewer = self._client()
        deadline, before = time.monotonic() + _SETTLES, b""
        while time.monotonic() < deadline:
            time.sleep(_PAUSE)
            views = viewer.get_state().views
            picture = viewer.take_screenshot()
            # Until the layout is in force there are views that the viewer made up.
            if picture == before and any(view.name.startswith(PARAMETERS) for view in views):
                with replacing(out) as partial:
                    partial.write_bytes(picture)
                return
            before = picture
        raise ViewerError(f"the picture did not come to rest within {_SETTLES:g} s; try again on an idle machine")

    def end(self) -> None:
        """End the recording; what was sent stays on show."""
        if self._rec is not None:
            self._rec.flush()
            self._rec.disconnect()
            self._rec = None


@contextlib.contextmanager
def live(
    how: str,
    *,
    file: Path | None = None,
    size: tuple[int, int] = (1600, 900),
    tell: Callable[[str], object] = print,
) -> Iterator[Live]:
    """Open what shows runs while they go on; it ends with the context.

    Parameters
    ----------
    how : {"window", "web", "headless", "save"}
        The viewer's window, a page on 127.0.0.1, nothing but pictures, or a recording in a file.
    file : Path, optional
        The recording (.rrd); an existing one is replaced. Of several runs the first has its name, others a number.
    size : tuple of int
        Width and height of pictures.
    tell : callable
        Called with the line that names the page.

    Raises
    ------
    FileMissingError
        If the folder of `file` does not exist.
    ViewerError
        If there is no display, or the viewer cannot start.
    """
    os.environ.setdefault("RERUN_ANALYTICS", "0")
    if how == "save":
        assert file is not None
        if not file.parent.is_dir():
            raise FileMissingError(f"the folder {file.parent} of {file.name} does not exist; create it first")
        names = iter([file, *(file.with_stem(f"{file.stem}_{number}") for number in range(2, 10_000))])
        shown = Live(lambda rec, layout: rec.save(next(names), default_blueprint=layout))
        try:
            yield shown
        finally:
            shown.end()
        return
    with listening(how, size) as (url, page, client, alive):
        if page:
            tell(f"open {page} in a browser")
        shown = Live(
            lambda rec, layout: rec.connect_grpc(url, default_blueprint=layout),
            client if how == "headless" else None,
            alive,
        )
        try:
            yield shown
        finally:
            shown.end()


def _layout(sensors: Mapping[str, str], paths: Mapping[str, str], *, alone: bool) -> rrb.Blueprint:
    """Return the views: curves, what is found since the run began, and what is said; or curves alone."""
    curves = [_series(paths[sensor], f"{sensor}: {label}", _WINDOW) for sensor, label in sensors.items()]
    panel = rrb.TimePanel(state="collapsed", timeline=RUN_TIME, play_state="following")
    if alone:
        about = rrb.TextDocumentView(origin="/status", name=PARAMETERS)
        body = rrb.Horizontal(rrb.Vertical(*curves), about, column_shares=[4.0, 1.4])
        return rrb.Blueprint(body, panel, collapse_panels=True)
    found = [
        _series("/phase", "Phase of the base at impacts [°]: L red, R blue", None, (0.0, 360.0)),
        _series("/found/response", "Largest |x1| [mm]", None),
        rrb.TimeSeriesView(
            origin="/found",
            contents=["/found/share", "/found/r"],
            name="Share of periods with the pattern, and r",
            axis_x=_window(None),
            axis_y=rrb.ScalarAxis(range=(0.0, 1.05)),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftBottom),
        ),
    ]
    said: Sequence[rrb.View] = [
        rrb.TextDocumentView(origin="/status", name=f"{PARAMETERS} and state"),
        rrb.TextLogView(
            origin="/lines",
            name="Once a second",
            columns=rrb.TextLogColumns(
                timeline_columns=[TimelineColumn(RUN_TIME, visible=False)], text_log_columns=["Body"]
            ),
        ),
    ]
    body = rrb.Horizontal(
        rrb.Vertical(*curves),
        rrb.Vertical(*found),
        rrb.Vertical(*said, row_shares=[2.0, 1.0]),
        column_shares=[3.4, 3.4, 2.6],
    )
    return rrb.Blueprint(body, panel, collapse_panels=True)


def _window(seconds: float | None) -> rrb.TimeAxis:
    """Return the last seconds, or all that there is."""
    boundary = rrb.TimeRangeBoundary
    start = boundary.infinite() if seconds is None else boundary.cursor_relative(seconds=-seconds)
    return rrb.TimeAxis(view_range=rrb.TimeRange(start=start, end=boundary.cursor_relative()))


def _series(
    origin: str, name: str, seconds: float | None, span: tuple[float, float] | None = None
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=origin,
        name=name,
        axis_x=_window(seconds),
        axis_y=None if span is None else rrb.ScalarAxis(range=span),
        plot_legend=rrb.PlotLegend(visible=False),
    )
