"""``vines view LOG…``: the Rerun viewer."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("view")
@click.argument("logs", nargs=-1, required=True, metavar="LOG...")
@click.option("--png", type=click.Path(dir_okay=False, path_type=Path), help="Draw a picture without any screen.")
@click.option(
    "--save",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write a recording (.rrd) with its blueprint.",
)
@click.option("--at", type=float, help="Simulation time that the picture shows; a moment near the end if left out.")
def command(logs: tuple[str, ...], png: Path | None, save: Path | None, at: float | None) -> None:
    """Look at logged runs in the Rerun viewer.

    LOG is <pipeline>.<stage>, <pipeline>.<stage>/<point>, a log id, or the path of an MCAP file.

    \b
    vines view quickstart.asymmetric_run
    vines view quickstart.doubled_run --png doubled.png
    """  # noqa: D301
    from vines.stages import find_logs
    from vines.viewer import save_rrd, screenshot, view

    paths = [path for name in logs for path in find_logs(name)]
    if png is None and save is None:
        view(paths)
        return
    if save is not None:
        save_rrd(paths, save)
        click.echo(f"wrote {save}")
    if png is not None:
        screenshot(paths, png, at=at)
        click.echo(f"wrote {png}")
