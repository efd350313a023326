"""``vines rig init``: a template of a run folder."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("init")
@click.argument("folder", type=click.Path(path_type=Path))
def command(folder: Path) -> None:
    """Write a commented template of a run folder to FOLDER; nothing is overwritten."""
    from vines.rig import write_template

    written = write_template(folder)
    click.echo(f"wrote {', '.join(path.name for path in written)} and raw/, derived/ in {folder}")
    click.echo("  copy the recorder's files into raw/, fill in run.json and channels.tsv (README.md explains), then")
    click.echo(f"  vines rig ingest {folder}")
