"""``vines rig formats``: which files can be read."""

from __future__ import annotations

import json

import click


@click.command("formats")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(as_json: bool) -> None:
    """List the formats of recordings that can be read, those of installed packages too."""
    from vines.cli._layout import print_rows
    from vines.rig.formats import list_formats

    found = list_formats()
    if as_json:
        click.echo(json.dumps(found, indent=1))
        return
    head = ["format", "name", "suffixes", "what is taken from a file", "package"]
    rows = [[row["label"], row["name"], " ".join(row["suffixes"]), row["summary"], row["package"]] for row in found]
    brought = any(row["package"] for row in found)
    print_rows(head if brought else head[:4], rows if brought else [row[:4] for row in rows], wrap=3)
