"""Start the Rerun viewer, with a window or without, and wait for it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import FrameType, MappingProxyType
from typing import IO, TYPE_CHECKING
from urllib.parse import quote

from vines.errors import ViewerError, ViewerStallError
from vines.viewer._page import guarded
from vines.viewer._style import OURS

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

__all__ = ["catalogue", "headless", "listening", "native", "native_url", "served"]

_START_SECONDS = 60.0
_END_SECONDS = 0.3
"""For which a program is waited for that was told to end."""
_LOOK_SECONDS = 0.05
"""Between two looks whether one has ended."""
_MEMORY = "2GB"
"""Of a viewer that shows a run while it goes on: what is older than fits is let go."""
_NO_VULKAN = ("Failed to get render context", "No graphics adapter", "No suitable graphics adapter")
"""What the viewer says on its way out where there is no Vulkan."""
_VULKAN = "on Debian: apt-get install mesa-vulkan-drivers libvulkan1"


def _program() -> str:
    """Return the path of the viewer's program."""
    spec = find_spec("rerun_cli")
    folder = Path(spec.origin).parent if spec and spec.origin else None
    name = "rerun.exe" if sys.platform == "win32" else "rerun"
    if folder is None or not (folder / name).is_file():
        raise ViewerError("the Rerun viewer is not installed; pip install rerun-sdk")
    return str(folder / name)


def _command(what: Path | str | None, port: int) -> list[str]:
    """Return the command line that all ways of showing share: it listens on this machine only."""
    given = [] if what is None else [str(what)]
    return [_program(), *given, "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen"]


def _environment(**more: str) -> dict[str, str]:
    return {**os.environ, "RERUN_ANALYTICS": "0", "NO_COLOR": "1", **more}


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def native(file: Path) -> None:
    """Show a recording in a window and wait until it is closed.

    Parameters
    ----------
    file : Path
        The .rrd file.

    Raises
    ------
    ViewerError
        If there is no display, or the viewer cannot start.
    """
    _shown(file)


def native_url(address: str) -> None:
    """Show what a server offers in a window and wait until it is closed; errors as :func:`native`."""
    _shown(address)


def _need_display() -> None:
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ViewerError(
            "the viewer needs a display and none is set (DISPLAY, WAYLAND_DISPLAY); "
            "serve a page with --web, write a picture with --png FILE or a recording with --save FILE.rrd"
        )


def _shown(what: Path | str) -> None:
    _need_display()
    with _sigterm_as_interrupt(), tempfile.TemporaryFile() as said:
        command = _command(what, _free_port())
        status = subprocess.run(command, env=_environment(), stdout=said, stderr=said, check=False).returncode
        if status != 0:
            raise ViewerError(_why(said, status))


@contextlib.contextmanager
def served(what: Path | str) -> Iterator[tuple[str, Callable[[], object]]]:
    """Serve the web viewer on 127.0.0.1, offline; it ends with the context.

    Parameters
    ----------
    what : Path or str
        A recording, or the address of a catalogue.

    Yields
    ------
    tuple of (str, callable)
        The page to open, and a function that waits until the server ends.

    Raises
    ------
    ViewerError
        If the server cannot start.
    """
    page, data = _free_port(), _free_port()
    command = [*_command(what, data), "--serve-web", "--web-viewer-port", str(page)]
    recording = isinstance(what, Path)
    with _running(command, [page, data] if recording else [page]) as process, guarded(page) as port:
        source = f"rerun+http://127.0.0.1:{data}/proxy" if recording else what
        # From here on Ctrl-C and SIGTERM are how it is meant to end, also before somebody waits.
        with contextlib.suppress(KeyboardInterrupt):
            yield f"http://127.0.0.1:{port}/?url={quote(str(source), safe='')}&theme=dark", partial(_wait, process)


@contextlib.contextmanager
def listening(
    how: str, size: tuple[int, int]
) -> Iterator[tuple[str, str, Callable[[], ViewerClient], Callable[[], bool]]]:
    """Run a viewer that shows what is sent to it; it ends with the context.

    Parameters
    ----------
    how : {"window", "web", "headless"}
        With a window, as a page on 127.0.0.1, or without either.
    size : tuple of int
        Width and height of what is drawn without a window, in points.

    Yields
    ------
    tuple of (str, str, callable, callable)
        Where to send, the page to open (empty if there is none), a function that connects a client to it, and one that
        says whether it still runs.

    Raises
    ------
    ViewerError
        If there is no display, or the viewer cannot start.
    """
    if how == "window":
        _need_display()
    data, page = _free_port(), _free_port()
    command = [*_command(None, data), "--memory-limit", _MEMORY]
    command += {
        "web": ["--serve-web", "--web-viewer-port", str(page), "--server-memory-limit", _MEMORY],
        "headless": ["--headless", "--window-size", f"{size[0]}x{size[1]}"],
    }.get(how, [])
    url = f"rerun+http://127.0.0.1:{data}/proxy"

    def client() -> ViewerClient:
        from rerun.experimental import ViewerClient

        return ViewerClient.connect(url)

    with contextlib.ExitStack() as stack:
        memory = stack.enter_context(tempfile.TemporaryDirectory())
        more = {"XDG_DATA_HOME": memory, "XDG_CONFIG_HOME": memory, "RUST_LOG": "error"} if how == "headless" else {}
        process = stack.enter_context(_running(command, [data, page] if how == "web" else [data], more))
        port = stack.enter_context(guarded(page)) if how == "web" else 0
        address = f"http://127.0.0.1:{port}/?url={quote(url, safe='')}&theme=dark" if port else ""
        yield url, address, client, lambda: process.poll() is None


@contextlib.contextmanager
def catalogue(folder: Path) -> Iterator[str]:
    """Run Rerun's catalogue server on 127.0.0.1 over a folder of recordings; it ends with the context.

    Parameters
    ----------
    folder : Path
        The recordings; its name is that of the dataset.

    Yields
    ------
    str
        The server's address.

    Raises
    ------
    ViewerError
        If the server cannot start.
    """
    port = _free_port()
    where = f"{folder.name}={folder}"
    command = [_program(), "server", "--host", "127.0.0.1", "--port", str(port), "--dataset", where]
    with _running(command, [port]):
        yield f"rerun+http://127.0.0.1:{port}"


@contextlib.contextmanager
def _sigterm_as_interrupt() -> Iterator[None]:
    """Let SIGTERM do what Ctrl-C does: by itself it would end Python at once and leave the viewer's server behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextlib.contextmanager
def _running(
    command: list[str], ports: list[int], more: Mapping[str, str] = MappingProxyType({})
) -> Iterator[subprocess.Popen[bytes]]:
    """Start a server, wait until it answers on all ports, and end it with the context."""
    with _sigterm_as_interrupt(), tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, env=_environment(**more), stdout=said, stderr=said)
        try:
            deadline = time.monotonic() + _START_SECONDS
            while not all(_answers(port) for port in ports):
                if process.poll() is not None:
                    raise ViewerError(_why(said, process.returncode))
                if time.monotonic() > deadline:
                    raise ViewerError(f"the server did not start within {_START_SECONDS:g} s; try again")
                time.sleep(0.1)
            yield process
        finally:
            _end(process)


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex(("127.0.0.1", port)) == 0


def _wait(process: subprocess.Popen[bytes]) -> None:
    """Wait until a program ends; ``Popen.wait`` goes on for a quarter of a second after Ctrl-C."""
    while process.poll() is None:
        time.sleep(_LOOK_SECONDS)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a program; what it shows lies in a file, so nothing is lost where it does not hear in time."""
    process.terminate()
    try:
        process.wait(timeout=_END_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextlib.contextmanager
def headless(file: Path, size: tuple[int, int], *, laid_out: bool = True) -> Iterator[ViewerClient]:
    """Run the viewer without a window on a recording, loaded; it ends with the context.

    Parameters
    ----------
    file : Path
        The .rrd file.
    size : tuple of int
        Width and height of what is drawn, in points.
    laid_out : bool
        Whether the recording brings a layout of vines, which is then waited for. A log opened bare does not.

    Raises
    ------
    ViewerError
        If the viewer cannot start (no Vulkan), does not load the recording within a minute, or stops answering.
    """
    from rerun.experimental import ViewerClient

    port = _free_port()
    arguments = ["--headless", "--window-size", f"{size[0]}x{size[1]}"]
    # The viewer's memory is a folder of its own: a layout that someone saved must not alter a picture. What it
    # logs below an error would show as notices over the views.
    with _sigterm_as_interrupt(), tempfile.TemporaryFile() as said, tempfile.TemporaryDirectory() as memory:
        environment = _environment(XDG_DATA_HOME=memory, XDG_CONFIG_HOME=memory, RUST_LOG="error")
        command = [*_command(file, port), *arguments]
        process = subprocess.Popen(command, env=environment, stdout=said, stderr=said)
        try:
            deadline = time.monotonic() + _START_SECONDS
            client = None
            while client is None:
                if process.poll() is not None:
                    kind = ViewerError if _no_vulkan(_text(said)) else ViewerStallError
                    raise kind(_why(said, process.returncode))
                if time.monotonic() > deadline:
                    raise ViewerStallError(
                        f"the viewer did not load {file.name} ({file.stat().st_size / 1e6:.0f} MB) within "
                        f"{_START_SECONDS:g} s{_last_words(said)}; try again on an idle machine"
                    )
                time.sleep(0.2)
                client = _loaded(ViewerClient, port, laid_out)
            yield client
        except (RuntimeError, ConnectionError) as lost:
            if isinstance(lost, ViewerError):
                raise
            said_so = " ".join(str(lost).split())
            raise ViewerStallError(
                f"the viewer stopped answering ({said_so}){_last_words(said)}; try again on an idle machine"
            ) from lost
        finally:
            _end(process)


def _loaded(kind: type[ViewerClient], port: int, laid_out: bool) -> ViewerClient | None:
    """Return a client once the viewer answers and has its recording and its views, else None."""
    if not _answers(port):
        return None
    try:
        client = kind.connect(f"rerun+http://127.0.0.1:{port}/proxy")
        state = client.get_state()
    except (RuntimeError, ConnectionError, ValueError):
        return None
    # Until the layout of the recording is in force, the viewer shows views that it made up.
    shown = any(view.name.startswith(OURS) for view in state.views) if laid_out else bool(state.views)
    there = bool(state.recordings) and bool(state.recordings[0].timelines)
    return client if shown and there and not state.loading else None


def _why(said: IO[bytes], status: int) -> str:
    """Return one line about a viewer that ended by itself, from what it printed."""
    text = _text(said)
    if _no_vulkan(text):
        return f"the viewer found no graphics adapter; Mesa's software Vulkan will do ({_VULKAN})"
    return (
        f"the viewer ended with status {status}: {_telling(text) or 'it said nothing'}; "
        "write a recording with --save FILE.rrd and open it where there is a display"
    )


def _no_vulkan(text: str) -> bool:
    return any(sign in text for sign in _NO_VULKAN)


def _text(said: IO[bytes]) -> str:
    said.seek(0)
    return said.read().decode(errors="replace")


def _telling(text: str) -> str:
    r"""Return the line of what the viewer printed that tells most, or nothing.

    Examples
    --------
    >>> _telling("thread main panicked at x.rs: no room\nnote: run with RUST_BACKTRACE=1\n")
    'thread main panicked at x.rs: no room'
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    telling = [line for line in lines if line.startswith("Error") or "panicked" in line] or lines or [""]
    return telling[-1]


def _last_words(said: IO[bytes]) -> str:
    """Return what a viewer that is stuck printed, as a part of a line."""
    words = _telling(_text(said))
    return f", it said: {words}" if words else ""
