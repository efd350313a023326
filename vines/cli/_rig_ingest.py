"""``vines rig ingest``: run folders into the catalogue."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._finite import finite
from vines.cli._study import the_study


@click.command("ingest")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--log-rate",
    type=click.FloatRange(min=0),
    callback=finite,
    default=2048.0,
    show_default=True,
    help="Samples a second of a channel in the logs at most; 0 keeps all.",
)
def command(folder: Path, log_rate: float) -> None:
    """Read the run folder FOLDER, or all in it, in SI units on one clock; nothing in it is changed.

    Refused, with the reason: no unit, sign, rate or sensitivity, too many clipped samples, clocks that can't be
    aligned, channels that contradict each other. The other runs are kept; exit code 1 if one was refused.

    \b
    vines rig ingest my_run
    vines query "select * from rig_channels"
    vines view rig_my_run.ingest
    """  # noqa: D301
    from vines.stages import ingest_folder

    found = ingest_folder(folder, log_rate=log_rate, study=the_study())
    good = len(found.runs) - len(found.refused)
    count = f"{good} run{'s' if good != 1 else ''}"
    if found.summary is None:
        click.echo(f"{folder}: nothing to do, its {count} are ingested already and unchanged (pipeline {found.name})")
    else:
        click.echo(f"{folder}: {count} ingested; raw files kept byte for byte (SHA256SUMS)")
        click.echo(f"  vines view {found.name}.ingest                 look at them")
        click.echo(f"  vines query \"select * from rig_channels where pipeline = '{found.name}'\"")
    for name, reason in found.refused.items():
        click.secho(f"{name} refused: {reason}", fg="red")
    raise click.exceptions.Exit(1 if found.refused else 0)
