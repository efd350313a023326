"""``vines init DIR``: a study of one's own."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Literal

import click

_FIRST = {"starter": "first", "quickstart": "quickstart", "paper": "quickstart"}


@click.command("init")
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
@click.option(
    "--from",
    "start",
    type=click.Choice(list(_FIRST)),
    default="starter",
    show_default=True,
    help="What to begin with: a small study, the quickstart, or all pipelines of the paper.",
)
def command(folder: Path, start: Literal["starter", "quickstart", "paper"]) -> None:
    """Start a study of your own in DIR: a folder with a pipeline that runs in seconds, to run and to change."""
    from vines.stages import init_study

    init_study(folder, start)
    click.echo(f"{folder} is ready; next:\n  cd {shlex.quote(str(folder))}\n  vines run {_FIRST[start]}")
