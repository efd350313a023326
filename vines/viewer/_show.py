"""Runs shown: a picture, a window, a page. Rerun is loaded only when one is asked for."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vines.errors import ViewerError, ViewerStallError
from vines.logs import Log
from vines.viewer._cache import cached_rrd
from vines.viewer._remarks import is_foreign
from vines.viewer._save import logs_of, record, replacing

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

__all__ = ["screenshot", "view", "web"]

_SETTLE_SECONDS = 30.0
_PAUSE_SECONDS = 0.4


def screenshot(
    logs: Sequence[str | os.PathLike[str] | Log],
    out: str | os.PathLike[str],
    *,
    at: float | None = None,
    size: tuple[int, int] = (1600, 900),
    overlay: bool = False,
    full: bool = False,
    tell: Callable[[str], object] | None = None,
) -> Path:
    """Draw runs as the viewer shows them, without a window, and keep the picture.

    Parameters
    ----------
    logs : sequence of path-like or Log
        One run, or several side by side.
    out : path-like
        The PNG file; an existing one is replaced.
    at : float, optional
        Time of the cursor, 1/omega0; shortly after an impact past the middle of the first run if left out.
    size : tuple of int
        Width and height in pixels.
    overlay : bool
        Whether the curves of all runs are in the same views.
    full : bool
        Whether every state of a long run is drawn.
    tell : callable, optional
        Called with a line when the viewer has to be started again.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileMissingError
        If a log or the folder of `out` does not exist.
    LogError
        If a log is damaged or incomplete.
    ParameterError
        If `at` lies before or after all runs.
    ViewerError
        If the viewer cannot start (it needs Vulkan; Mesa's software one will do), a view reports an error, or the
        picture does not come to rest.
    """
    from vines.viewer._cursor import set_time
    from vines.viewer._program import headless

    runs = logs_of(logs)
    moment = _moment(runs[0]) if at is None else at
    with replacing(Path(out)) as partial, tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "still.rrd"
        record(runs, recording, still=True, overlay=overlay, at=moment, full=full)
        ours = not any(map(is_foreign, runs))

        def drawing() -> bytes:
            with headless(recording, size, laid_out=ours) as viewer:
                if ours:
                    set_time(viewer, runs, moment)
                picture = _at_rest(viewer)
                reports = [
                    f"{view.name}: {report.summary}"
                    for view in viewer.get_state().views
                    for report in view.reports
                    if report.severity == "error"
                ]
            if reports:
                raise ViewerError(f"the viewer could not draw {'; '.join(reports)}")
            return picture

        partial.write_bytes(_twice(drawing, tell))
    return Path(out)


def _twice(drawing: Callable[[], bytes], tell: Callable[[str], object] | None) -> bytes:
    """Return a picture, of a second start of the viewer if the first came to nothing for want of time or luck."""
    try:
        return drawing()
    except ViewerStallError as first:
        if tell is not None:
            tell(f"{first}; it is started once more")
        return drawing()


def view(
    logs: Sequence[str | os.PathLike[str] | Log],
    *,
    cache: Path | None = None,
    overlay: bool = False,
    at: float | None = None,
    full: bool = False,
) -> None:
    """Show runs in the viewer and wait until its window is closed.

    Parameters
    ----------
    logs : sequence of path-like or Log
        One run, or several side by side.
    cache : Path, optional
        Folder where their recording is kept for the next time.
    overlay : bool
        Whether the curves of all runs are in the same views; such a recording is not kept.
    at, full : float or None, bool
        What is drawn of a long run, as in :func:`vines.viewer.save_rrd`.

    Raises
    ------
    FileMissingError
        If a log does not exist.
    LogError
        If a log is damaged or incomplete.
    ViewerError
        If there is no display, or the viewer cannot start.
    """
    from vines.viewer._program import native

    with _recorded(logs, None if overlay else cache, overlay=overlay, at=at, full=full) as recording:
        native(recording)


def web(
    logs: Sequence[str | os.PathLike[str] | Log],
    *,
    cache: Path | None = None,
    tell: Callable[[str], object] = print,
    overlay: bool = False,
    at: float | None = None,
    full: bool = False,
) -> None:
    """Serve runs in the web viewer, offline and on 127.0.0.1 only, until Ctrl-C.

    Parameters
    ----------
    logs : sequence of path-like or Log
        One run, or several side by side.
    cache : Path, optional
        Folder where their recording is kept for the next time.
    tell : callable
        Called with the line that names the page.
    overlay : bool
        Whether the curves of all runs are in the same views; such a recording is not kept.
    at, full : float or None, bool
        What is drawn of a long run, as in :func:`vines.viewer.save_rrd`.

    Raises
    ------
    FileMissingError
        If a log does not exist.
    LogError
        If a log is damaged or incomplete.
    ViewerError
        If the server cannot start.
    """
    from vines.viewer._program import served

    with (
        _recorded(logs, None if overlay else cache, overlay=overlay, at=at, full=full) as recording,
        served(recording) as (url, wait),
    ):
        tell(f"open {url} in a browser; Ctrl-C ends it")
        wait()


@contextmanager
def _recorded(
    logs: Sequence[str | os.PathLike[str] | Log],
    cache: Path | None,
    *,
    overlay: bool,
    at: float | None,
    full: bool,
) -> Iterator[Path]:
    """Give a recording of runs, from the cache if there is one."""
    if cache is not None:
        yield cached_rrd(logs, cache, at=at, full=full)
        return
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "vines.rrd"
        record(logs, recording, overlay=overlay, at=at, full=full)
        yield recording


def _moment(log: Log) -> float:
    """Return a time at which a picture shows something: a tenth of a cycle after an impact past the middle."""
    if not log.states.num_rows:
        return 0.0
    times = log.states["t"].to_numpy()
    middle = float(times[0] + 0.55 * (times[-1] - times[0]))
    later = [t for t in log.impacts["t"].to_pylist() if t > middle]
    if not later:
        return middle
    return min(later[0] + 0.1 * 6.2832 / log.parameters.get("Omega", 1.0), float(times[-1]))


def _at_rest(viewer: ViewerClient) -> bytes:
    """Return a picture once two in a row are equal: views have settled and notices have gone."""
    deadline = time.monotonic() + _SETTLE_SECONDS
    before = b""
    while time.monotonic() < deadline:
        time.sleep(_PAUSE_SECONDS)
        picture = viewer.take_screenshot()
        if picture == before:
            return picture
        before = picture
    raise ViewerStallError(
        f"the picture did not come to rest within {_SETTLE_SECONDS:g} s; try again on an idle machine"
    )
