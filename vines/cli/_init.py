"""``vines init DIR``: a study of one's own."""

from __future__ import annotations

import shlex
from pathlib import Path

import click


@click.command("init")
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
def command(folder: Path) -> None:
    """Start a study of your own in DIR: a folder with the pipelines that ship with vines, to run and to change."""
    from vines.stages import init_study

    init_study(folder)
    click.echo(f"{folder} is ready; next:\n  cd {shlex.quote(str(folder))}\n  vines run quickstart")
