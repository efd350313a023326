"""``vines rig init``: a run folder or a campaign to fill in, as far as recordings do not say it themselves."""

from __future__ import annotations

from pathlib import Path

import click

from vines.errors import ParameterError

_PATH = click.Path(path_type=Path)


@click.command("init")
@click.argument("folder", type=_PATH)
@click.option(
    "--from", "recordings", type=_PATH, multiple=True, help="A recording, or a folder of them, copied into raw/."
)
@click.option("--like", type=_PATH, help="A run folder whose description is taken, but for what is of its day.")
@click.option("--campaign", is_flag=True, help="A rig.json for all runs, and a run folder for each --from.")
@click.option(
    "--protocol",
    type=click.Choice(["dwell", "sweep_up", "sweep_down", "ringdown"]),
    help="What was done; else a recording is asked whether it is a free decay.",
)
def command(
    folder: Path, recordings: tuple[Path, ...], like: Path | None, campaign: bool, protocol: str | None
) -> None:
    """Write a run folder to FOLDER, or a campaign, with a comment for every entry; nothing is overwritten.

    A recording fills in its channels, units, rates, start, its layout, and proposes roles and the forcing; what it does
    not know is null and is asked for. Beside a rig.json a run holds only what is its own.

    \b
    vines rig init my_run                                    a template
    vines rig init march --campaign --from recordings        a campaign, a run for each file in recordings/
    vines rig init march/c --from c.tdms --like march/b      one run more
    """  # noqa: D301
    from vines.rig import init_campaign, init_run

    if campaign and like is not None:
        raise ParameterError("--like takes a run, and --campaign says what runs share; use one of them")
    made = init_campaign(folder, recordings, protocol) if campaign else init_run(folder, recordings, like, protocol)
    for path in made.files:
        left = f", {made.todo[path]} entries still null" if path in made.todo else ""
        click.echo(f"wrote {path}{left}")
    for remark in made.remarks:
        click.echo(f"  {remark}")
    if not recordings:
        click.echo(
            f"  copy the recorder's files into raw/, fill in {' and '.join(path.name for path in made.files[:2])}"
        )
    click.echo("  README.md explains every entry; then")
    click.echo(f"  vines rig ingest {folder}")
