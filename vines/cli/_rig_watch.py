"""``vines rig watch``: a run while it goes on."""

from __future__ import annotations

import contextlib
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vines.cli._finite import finite

if TYPE_CHECKING:
    from vines.rig.watch import Report, Stream
    from vines.stages import Watched

_FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("watch")
@click.argument("source")
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("watched"),
    show_default=True,
    help="Folder for logs and run folders; a campaign, too.",
)
@click.option("--name", help="Of the run folder of a live stream.")
@click.option("--seconds", type=click.FloatRange(min=0, min_open=True), callback=finite, help="How long to log.")
@click.option("--settled", is_flag=True, help="Log a live stream only from when it has settled.")
@click.option("--channels", type=_FILE, help="channels.tsv of a device or of files.")
@click.option("--b", type=click.FloatRange(min=0, min_open=True), help="[m] Half length of the cavity less the ball.")
@click.option(
    "--memory", type=click.FloatRange(min=0, min_open=True), help="[s] 2M/c, in which a free motion falls to 1/e."
)
@click.option("--no-view", is_flag=True, help="Show nothing but lines.")
@click.option("--web", is_flag=True, help="Show it on a page on 127.0.0.1.")
@click.option("--save", type=_FILE, help="Write a recording (.rrd) instead of showing it.")
@click.option("--png", type=_FILE, help="Draw what is shown at the end, without any screen.")
@click.option(
    "--foxglove",
    type=click.IntRange(1, 65535),
    is_flag=False,
    flag_value=8765,
    metavar="[PORT]",
    help="Serve Foxglove on 127.0.0.1 (ws://127.0.0.1:8765).",
)
@click.option("--present", is_flag=True, help="Files that are in the folder already, too.")
@click.option(
    "--steady",
    type=click.FloatRange(min=0),
    callback=finite,
    default=2.0,
    show_default=True,
    help="[s] A file that does not change for so long is complete.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of the synthetic rig.")
@click.option("--set", "given", multiple=True, metavar="K=V", help="A setting of the synthetic rig, e.g. E=2.5e-4.")
@click.option(
    "--speed",
    type=click.FloatRange(min=0, min_open=True),
    callback=finite,
    default=1.0,
    show_default=True,
    help="Seconds of the synthetic rig in a second.",
)
@click.option("--json", "as_json", is_flag=True, help="A line of JSON a second, for machines.")
def command(
    source: str,
    out: Path,
    name: str | None,
    seconds: float | None,
    settled: bool,
    channels: Path | None,
    b: float | None,
    memory: float | None,
    no_view: bool,
    web: bool,
    save: Path | None,
    png: Path | None,
    foxglove: int | None,
    present: bool,
    steady: float,
    seed: int,
    given: tuple[str, ...],
    speed: float,
    as_json: bool,
) -> None:
    """Watch SOURCE while the experiment runs: log it, show it, and say once a second how it goes.

    SOURCE is a folder in which recordings appear, tcp://HOST:PORT or listen://PORT of a program that sends samples,
    ni://Dev1/ai0:3?rate=51200, or synth: for the synthetic rig. Ctrl-C ends it; the log is complete then, and its run
    folder is ingested and reconstructed as any other.

    \b
    vines rig watch recordings
    vines rig watch listen://5555 --out march --name up_7
    vines rig watch synth: --set E=2.5e-4 --web
    """  # noqa: D301
    from vines.stages import watch_rig

    shown = [option for option, on in (("--no-view", no_view), ("--web", web), ("--save", save), ("--png", png)) if on]
    if len(shown) > 1:
        raise click.UsageError(f"{' and '.join(shown)} exclude each other; give one of them")
    for option, file, suffix in (("--save", save, ".rrd"), ("--png", png, ".png")):
        if file is not None and file.suffix.lower() != suffix:
            raise click.UsageError(f"{option} {file}: its name ends in {suffix}, such as {file.with_suffix(suffix)}")
    opened = _source(source, channels, given, seed, speed, steady, present)
    if memory is None and source.startswith("synth:"):
        memory = opened.memory
    told: _Lines = _Json() if as_json else (_Screen() if sys.stdout.isatty() else _Lines())
    how = {"--no-view": None, "--web": "web", "--save": "save", "--png": "headless"}[shown[0]] if shown else "window"
    with contextlib.ExitStack() as stack:
        stack.callback(opened.close)
        show = serve = None
        if how is not None:
            from vines.viewer import live

            show = stack.enter_context(live(how, file=save, tell=told.remark))
        if foxglove is not None:
            from vines.stages import foxglove_server

            serve = stack.enter_context(foxglove_server(foxglove))
            told.remark(f"Foxglove: open connection ws://127.0.0.1:{foxglove}")
        with told:
            watch_rig(
                opened,
                told,
                out=out,
                name=name,
                settled_first=settled,
                seconds=seconds,
                show=show,
                foxglove=serve,
                b=b,
                memory=memory,
            )
        if png is not None and show is not None:
            show.picture(png)
            told.remark(f"wrote {png}")
        elif save is not None:
            told.remark(f"wrote {save}")


def _source(
    text: str, channels: Path | None, given: tuple[str, ...], seed: int, speed: float, steady: float, present: bool
) -> Any:
    """Return the source, with what describes it."""
    import msgspec

    from vines.cli._rig_synth import read_settings
    from vines.errors import ParameterError
    from vines.rig.ingest import read_cells
    from vines.rig.synth import RigSettings
    from vines.rig.watch import open_source

    if given and not text.startswith("synth:"):
        raise click.UsageError(f"--set is for the synthetic rig, synth:, not for {text}")
    try:
        settings = msgspec.convert({"settle": 0.0, **read_settings(given)}, RigSettings)
    except msgspec.ValidationError as unfit:
        raise ParameterError(f"--set: {unfit}") from None
    rows = () if channels is None else read_cells(channels)
    return open_source(text, rows=rows, settings=settings, seed=seed, speed=speed, steady=steady, present=present)


class _Lines:
    """Writes a line for each thing."""

    def __enter__(self) -> _Lines:
        return self

    def __exit__(self, *ignored: object) -> None:
        return None

    def began(self, stream: Stream, log: Path | None) -> None:
        """Say what is watched."""
        channels = ", ".join(each.name for each in stream.channels)
        where = "" if log is None else f", logged to {log}"
        self.say(f"watching {stream.name}: {channels} at {stream.rate:.9g} Hz{where}")

    def report(self, report: Report) -> None:
        """Say how it goes."""
        from vines.stages import report_line

        self.say(report_line(report))

    def remark(self, text: str) -> None:
        """Say what has to be known."""
        click.secho(text, fg="yellow", err=True)

    def ended(self, watched: Watched) -> None:
        """Say what there is now, and the way to the verdict."""
        for line in _after(watched):
            self.say(line)

    def say(self, text: str) -> None:
        """Write a line at once: whoever reads it may be a program."""
        click.echo(text)
        sys.stdout.flush()


class _Screen(_Lines):
    """Keeps a table of the channels and the last line in place on a terminal."""

    def __init__(self) -> None:
        from rich.live import Live

        self._live = Live(auto_refresh=False, transient=False)

    def __enter__(self) -> _Screen:
        self._live.start()
        return self

    def __exit__(self, *ignored: object) -> None:
        self._live.stop()

    def report(self, report: Report) -> None:
        """Draw the table anew."""
        from rich.console import Group
        from rich.table import Table
        from rich.text import Text

        from vines.stages import report_line

        table = Table(box=None, pad_edge=False)
        for head in ("channel", "rms", "peak", "range used", "clipped"):
            table.add_column(head, justify="left" if head == "channel" else "right")
        for name, level in report.levels.items():
            used = "" if level.full is None else f"{'▮' * round(10 * min(level.full, 1.0)):<10} {level.full:4.0%}"
            style = "red" if level.clipped else ""
            cells = (f"{level.rms:.3g} {level.unit}", f"{level.peak:.3g} {level.unit}", used, str(level.clipped_since))
            table.add_row(name, *cells, style=style)
        line = Text(report_line(report), style="green" if report.settled else "")
        self._live.update(Group(table, line), refresh=True)

    def say(self, text: str) -> None:
        """Write a line above the table."""
        self._live.console.print(text, markup=False, highlight=False, soft_wrap=True)

    def remark(self, text: str) -> None:
        """Write a remark above the table."""
        self._live.console.print(text, markup=False, highlight=False, style="yellow", soft_wrap=True)


class _Json(_Lines):
    """Writes an object a line."""

    def began(self, stream: Stream, log: Path | None) -> None:
        """Say what is watched."""
        self._write(
            {"watching": stream.name, "channels": [c.name for c in stream.channels], "rate": stream.rate, "log": log}
        )

    def report(self, report: Report) -> None:
        """Say how it goes."""
        self._write(report)

    def remark(self, text: str) -> None:
        """Say what has to be known."""
        self._write({"remark": text})

    def ended(self, watched: Watched) -> None:
        """Say what there is now."""
        told = {"ended": watched.name, "seconds": watched.seconds, "log": watched.log, "folder": watched.folder}
        self._write({**told, "file": watched.file, "missing": watched.missing, "transient": watched.transient})

    def _write(self, content: Any) -> None:
        import msgspec

        self.say(msgspec.json.encode(content, enc_hook=str).decode())


def _after(watched: Watched) -> list[str]:
    """Return what there is now and what may follow, a line each."""
    lines = [f"{watched.name}: {watched.seconds:.1f} s" + (f", log {watched.log}" if watched.log else ", not logged")]
    if watched.log is not None:
        lines.append(f"  {shlex.join(['vines', 'view', str(watched.log)])}")
    if watched.folder is not None:
        folder = str(watched.folder)
        if watched.missing:
            lines.append(f"  fill in {watched.folder / 'run.json'}: {', '.join(watched.missing)}")
        lines.append(f"  {shlex.join(['vines', 'rig', 'compare', folder])}   with its ring-down beside it")
        if watched.transient is not None and watched.transient > 15.0:
            lines.append(f"  its first {watched.transient:.0f} s are a transient: --settled logs only what comes after")
    elif watched.file is not None:
        lines.append(f"  {shlex.join(['vines', 'rig', 'init', watched.name, '--from', str(watched.file)])}")
    return lines
