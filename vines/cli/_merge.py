"""``vines merge NAME``: results from what shards computed."""

from __future__ import annotations

import click

from vines.cli._study import the_study


@click.command("merge")
@click.argument("name", metavar="NAME|FILE")
@click.option("--set", "settings", multiple=True, metavar="K=V", help="The same values as for the shards.")
@click.option("--quiet", is_flag=True, help="Show no progress.")
def command(name: str, settings: tuple[str, ...], quiet: bool) -> None:
    """Put the results of the pipeline NAME together from the points that 'vines run NAME --shard i/n' computed.

    Computes no point; stages that take whole results, such as figures and checks, are run. Says what is missing if
    shards are not finished.
    """
    from vines.cli._progress import progress
    from vines.cli._run import read_setting
    from vines.stages import run

    overrides = dict(read_setting(text) for text in settings)
    with progress(quiet) as report:
        run(name, overrides=overrides, merge=True, report=report, study=the_study())
