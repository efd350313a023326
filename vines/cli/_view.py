"""``vines view LOG…``: the Rerun viewer."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._finite import finite
from vines.cli._max_chunk import max_chunk_option
from vines.cli._study import the_study
from vines.errors import printable

_FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("view")
@click.argument("logs", nargs=-1, required=True, metavar="LOG...")
@click.option("--web", is_flag=True, help="Serve the web viewer on 127.0.0.1 and print its page; needs no network.")
@click.option("--png", type=_FILE, help="Draw a picture without any screen.")
@click.option("--save", type=_FILE, help="Write a recording (.rrd) with its blueprint.")
@click.option("--overlay", is_flag=True, help="Curves of all runs in the same views, as of a rig and of the model.")
@click.option("--follow", is_flag=True, help="One that is still being written, as it grows.")
@click.option(
    "--at",
    type=float,
    callback=finite,
    help="Simulation time that the picture shows; a moment past the middle if left out.",
)
@max_chunk_option
def command(
    logs: tuple[str, ...],
    web: bool,
    png: Path | None,
    save: Path | None,
    overlay: bool,
    follow: bool,
    at: float | None,
    max_chunk: int,
) -> None:
    """Look at logged runs in the Rerun viewer, several side by side or laid over each other.

    LOG is <pipeline>.<stage>, <pipeline>.<stage>/<point>, a log id, or the path of an MCAP file. What is missing from a
    log, or was done to it by another program, is told on stderr.

    \b
    vines view quickstart.asymmetric_run
    vines view quickstart.doubled_run --png doubled.png
    vines view rehearsal.compare/01_up --overlay        measured and modelled
    vines view --follow watched/up_7/raw/up_7.mcap      while it is written
    """  # noqa: D301
    from vines import viewer
    from vines.logs import read_damaged
    from vines.stages import find_logs, recordings_folder

    if web and (png is not None or save is not None):
        raise click.UsageError("--web serves until Ctrl-C and goes with neither --png nor --save; give one of them")
    for option, file, suffix, what in (("--png", png, ".png", "a picture"), ("--save", save, ".rrd", "a recording")):
        if file is not None and file.suffix.lower() != suffix:
            raise click.UsageError(f"{option} {file}: {what} ends in {suffix}, such as {file.with_suffix(suffix)}")
    if at is not None and png is None:
        raise click.UsageError("--at is the time of a picture; give --png FILE too")
    if follow:
        _follow(logs, web=web, png=png, save=save, alone=overlay or at is not None)
        return
    study = the_study()
    limit = max_chunk * 2**20
    runs = [read_damaged(path, max_chunk=limit) for name in logs for path in find_logs(name, study=study)]
    for run in runs:
        for line in viewer.remarks(run):
            click.echo(f"vines: {printable(str(run.path))}: {line}", err=True)
    if save is not None:
        viewer.save_rrd(runs, save, overlay=overlay)
        click.echo(f"wrote {save}")
    if png is not None:
        viewer.screenshot(runs, png, at=at, overlay=overlay)
        click.echo(f"wrote {png}")
    if web:
        viewer.web(runs, cache=recordings_folder(study=study), tell=click.echo, overlay=overlay)
    elif png is None and save is None:
        viewer.view(runs, cache=recordings_folder(study=study), overlay=overlay)


def _follow(logs: tuple[str, ...], *, web: bool, png: Path | None, save: Path | None, alone: bool) -> None:
    """Show a log that is being written."""
    from vines import viewer

    if len(logs) != 1 or alone or (png is not None and save is not None):
        raise click.UsageError("--follow takes the path of one log, and one of --web, --png and --save at most")
    how = "web" if web else "headless" if png is not None else "save" if save is not None else "window"
    viewer.follow(logs[0], how, file=save, picture=png, tell=click.echo)
    for file in (png, save):
        if file is not None:
            click.echo(f"wrote {file}")
