"""``vines recover FILE.mcap``: save what is intact in a damaged log."""

from __future__ import annotations

import json
from pathlib import Path

import click

from vines.cli._max_chunk import max_chunk_option
from vines.errors import printable


@click.command("recover")
@click.argument("file", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE.mcap")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="The new file; it must not exist.")
@max_chunk_option
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(file: Path, out: Path | None, max_chunk: int, as_json: bool) -> None:
    """Save what is intact in a truncated, damaged or unfinished MCAP file into a new one, and say what was lost.

    The damaged file is not touched and nothing is overwritten. The new file is FILE.recovered.mcap, and readers see
    that it was recovered. A log that a killed process left behind is called FILE.mcap.part.
    """
    from vines.logs import recover

    done = recover(file, out, max_chunk=max_chunk * 2**20)
    if as_json:
        click.echo(json.dumps({"path": str(done.path), "saved": done.saved, "lost": done.lost}, indent=2))
        return
    click.echo(f"wrote {printable(str(done.path))}")
    for line in done.saved:
        click.echo(f"saved  {line}")
    for line in done.lost or ("nothing",):
        click.echo(f"lost   {line}")
