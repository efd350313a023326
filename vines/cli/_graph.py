"""``vines graph NAME``: a pipeline as a Mermaid flowchart."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._study import the_study
from vines.errors import StoreError


@click.command("graph")
@click.argument("name", metavar="NAME|FILE")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to this file, not the screen.")
def command(name: str, out: Path | None) -> None:
    """Draw the stages of the pipeline NAME, what they need and where they stand, as a Mermaid flowchart.

    GitHub, GitLab and most editors draw it where it stands in Markdown between ```mermaid and ```.
    """
    from vines.stages import graph

    text = graph(name, study=the_study())
    if out is None:
        click.echo(text)
    elif not out.parent.is_dir():
        raise StoreError(f"{out}: the folder {out.parent} does not exist; make it first")
    else:
        out.write_text(text + "\n", encoding="utf-8")
