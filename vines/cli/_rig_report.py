"""``vines rig report``: one page about a campaign."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._study import the_study


@click.command("report")
@click.argument("source", metavar="FOLDER|PIPELINE")
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("report.html"),
    show_default=True,
    help="The page: .html, .pdf (printed by Chromium) or .md.",
)
def command(source: str, out: Path) -> None:
    """Write a page about a campaign, of a folder of runs or of a pipeline that has compared them.

    Set-up, calibration of the sensors, ring-downs, each run's verdict with its reason, the uncertainty budget by
    source, gates and checks that failed, comparison figures, versions and hashes of the raw files.

    \b
    vines rig report march --out march.pdf
    vines rig report rehearsal --out rehearsal.html
    """  # noqa: D301
    from vines.stages import compile_for, report_campaign

    compile_for("compare", lambda line: click.echo(line, err=True))
    path = report_campaign(source, out, study=the_study())
    click.echo(f"wrote {path}  ({path.stat().st_size / 1e3:.0f} kB)")
