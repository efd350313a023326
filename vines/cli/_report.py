"""``vines report NAME``: one self-contained HTML page."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._study import the_study


@click.command("report")
@click.argument("name")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="The file; else data/reports/NAME.html.")
def command(name: str, out: Path | None) -> None:
    """Write a page about the pipeline or collection NAME: figures that zoom, checks, tables, runs, provenance.

    The page is one HTML file that any browser opens without a network. It shows what is stored; run NAME first.
    """
    from vines.stages import report

    path = report(name, out, study=the_study())
    click.echo(f"{path}  ({path.stat().st_size / 1e6:.1f} MB)")
