"""``vines view LOG…``: the Rerun viewer."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from vines.cli._finite import finite
from vines.cli._max_chunk import max_chunk_option
from vines.cli._study import the_study
from vines.errors import printable

if TYPE_CHECKING:
    from vines.logs import Log

_LONG = 20_000_000
"""Bytes of a log from which on it takes a while, and is told what goes on."""
_SIZE = (1600, 900)
_SIDE = (200, 8000)
"""Least and greatest width and height of a picture, pixels."""
_FILE = click.Path(dir_okay=False, path_type=Path)


def _pixels(context: click.Context, option: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """Read a size such as 1600x900; the callback of an option.

    Raises
    ------
    click.BadParameter
        If it is none, or a side is out of range.
    """
    if value is None:
        return None
    found = re.fullmatch(r"(\d{1,6})[x×](\d{1,6})", value.strip())
    if found is None or not all(_SIDE[0] <= int(side) <= _SIDE[1] for side in found.groups()):
        least, most = _SIDE
        allowed = f"allowed is WIDTHxHEIGHT with {least} to {most} pixels a side, such as 1600x900"
        raise click.BadParameter(f"{value!r} is no size; {allowed}.", context, option)
    return int(found[1]), int(found[2])


@click.command("view")
@click.argument("logs", nargs=-1, required=True, metavar="LOG...")
@click.option("--web", is_flag=True, help="Serve the web viewer on 127.0.0.1 and print its page; needs no network.")
@click.option("--png", type=_FILE, help="Draw a picture without any screen.")
@click.option("--save", type=_FILE, help="Write a recording (.rrd) with its blueprint.")
@click.option("--video", type=_FILE, help="Write a film of the motion (.mp4 or .gif); needs no viewer.")
@click.option("--periods", type=click.FloatRange(0, min_open=True), help="Forcing cycles of the film; ten if left out.")
@click.option("--fps", type=click.IntRange(1, 100), help="Frames a second of the film, 25 if left out.")
@click.option("--overlay", is_flag=True, help="Curves of all runs in the same views, as of a rig and of the model.")
@click.option("--follow", is_flag=True, help="One that is still being written, as it grows.")
@click.option(
    "--at",
    type=float,
    callback=finite,
    help="Time that the picture shows and around which a long run is drawn in full; past the middle if left out.",
)
@click.option("--full", is_flag=True, help="Draw every state of a long run, not only the peaks of its curves.")
@click.option("--size", callback=_pixels, metavar="WxH", help="Pixels of the picture (1600x900) or film (800x450).")
@max_chunk_option
def command(
    logs: tuple[str, ...],
    web: bool,
    png: Path | None,
    save: Path | None,
    video: Path | None,
    periods: float | None,
    fps: int | None,
    overlay: bool,
    follow: bool,
    at: float | None,
    full: bool,
    size: tuple[int, int] | None,
    max_chunk: int,
) -> None:
    """Look at logged runs in the Rerun viewer, several side by side or laid over each other.

    LOG is <pipeline>.<stage>, <pipeline>.<stage>/<point>, a log id, or the path of an MCAP file. What is missing from a
    log, or was done to it by another program, is told on stderr.

    \b
    vines view quickstart.asymmetric_run
    vines view quickstart.doubled_run --png doubled.png
    vines view quickstart.doubled_run --video doubled.gif --periods 4
    vines view rehearsal.compare/01_up --overlay        measured and modelled
    vines view --follow watched/up_7/raw/up_7.mcap      while it is written
    """  # noqa: D301
    from vines import viewer
    from vines.logs import read_damaged
    from vines.stages import MOST_ABREAST, find_logs, recordings_folder

    if web and (png is not None or save is not None):
        raise click.UsageError("--web serves until Ctrl-C and goes with neither --png nor --save; give one of them")
    for option, file, suffix, what in (("--png", png, ".png", "a picture"), ("--save", save, ".rrd", "a recording")):
        if file is not None and file.suffix.lower() != suffix:
            raise click.UsageError(f"{option} {file}: {what} ends in {suffix}, such as {file.with_suffix(suffix)}")
    if size is not None and png is None and video is None:
        raise click.UsageError("--size is that of a picture or film; give --png FILE or --video FILE too")
    if (periods is not None or fps is not None) and video is None:
        raise click.UsageError("--periods and --fps are those of a film; give --video FILE too")
    if video is not None and (web or len(logs) > 1):
        raise click.UsageError("--video is a film of one run and goes without --web; name one log")
    if follow:
        alone = overlay or full or at is not None or video is not None or size is not None
        _follow(logs, web=web, png=png, save=save, alone=alone)
        return
    study = the_study()
    limit = max_chunk * 2**20

    def told(line: str) -> None:
        click.echo(f"vines: {line}", err=True)

    paths = [path for name in logs for path in find_logs(name, study=study)]
    if len(paths) > MOST_ABREAST:
        example = f"{next(iter(logs)).partition('/')[0]}/{paths[0].stem}"
        raise click.UsageError(
            f"{' '.join(logs)} has {len(paths)} logs, and {MOST_ABREAST} fit beside each other; name points, such as "
            f"{example}, or look at all in 'vines browse {' '.join(logs)}'"
        )
    runs: list[Log] = []
    long = False
    for path in paths:
        if path.stat().st_size > _LONG:
            long = True
            told(f"reading {printable(path.name)}, {path.stat().st_size / 1e6:.0f} MB")
        runs.append(read_damaged(path, max_chunk=limit))
    for run in runs:
        for line in viewer.remarks(run, full=full):
            told(f"{printable(str(run.path))}: {line}")
    if long:
        told("drawing")
    if save is not None:
        viewer.save_rrd(runs, save, overlay=overlay, at=at, full=full)
        click.echo(f"wrote {save}")
    if png is not None:
        viewer.screenshot(runs, png, at=at, size=size or _SIZE, overlay=overlay, full=full, tell=told)
        click.echo(f"wrote {png}")
    if video is not None:
        if len(runs) != 1:
            raise click.UsageError(f"--video is a film of one run, {' '.join(logs)} has {len(runs)}; name one point")
        viewer.video(runs[0], video, periods=periods, fps=fps or 25, size=size or (800, 450))
        click.echo(f"wrote {video}")
    if web:
        viewer.web(runs, cache=recordings_folder(study=study), tell=click.echo, overlay=overlay, at=at, full=full)
    elif png is None and save is None and video is None:
        viewer.view(runs, cache=recordings_folder(study=study), overlay=overlay, at=at, full=full)


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
