"""``vines gc``: remove what no pin refers to."""

from __future__ import annotations

import json

import click

from vines.cli._study import the_study


@click.command("gc")
@click.option("--yes", is_flag=True, help="Remove it; without this, only say what would go.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(yes: bool, as_json: bool) -> None:
    """Find results and points that no pipeline refers to any more, and remove them with --yes.

    Kept is what is pinned (see 'vines status'), and the points of stages as they are declared now, so that an
    interrupted run goes on.
    """
    from vines.stages import clean

    garbage = clean(remove=yes, study=the_study())
    if as_json:
        rows = [{"what": each.what, "key": each.key, "bytes": each.bytes} for each in garbage]
        click.echo(json.dumps({"removed": yes, "found": rows}, indent=2))
        return
    if not garbage:
        click.echo("nothing to remove: everything is referred to")
        return
    from vines.cli._layout import print_rows

    print_rows(["what", "key", "MB"], [[each.what, each.key[:12], round(each.bytes / 1e6, 2)] for each in garbage])
    total = sum(each.bytes for each in garbage) / 1e6
    click.echo(f"{total:.1f} MB {'removed' if yes else 'would be removed; vines gc --yes does it'}")
