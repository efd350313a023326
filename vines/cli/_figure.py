"""``vines figure NAME``: a figure as a file for a paper or a thesis."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._study import the_study


@click.command("figure")
@click.argument("name", metavar="NAME[.STAGE]")
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="The file, .pdf, .svg or .png; else NAME.STAGE.pdf here.",
)
@click.option("--width", metavar="W", help="Width with unit, e.g. 85mm, 8.5cm, 3.35in; else as declared.")
@click.option("--dpi", type=click.IntRange(30, 2400), help="Pixels per inch of a PNG; else 300.")
@click.option("--style", metavar="S", help="A style sheet of matplotlib (.mplstyle), or the name of one.")
@click.option(
    "--set", "settings", multiple=True, metavar="K=V", help="Replace a value, e.g. stages.response.title='A title'."
)
def command(
    name: str, out: Path | None, width: str | None, dpi: int | None, style: str | None, settings: tuple[str, ...]
) -> None:
    """Draw a figure of a pipeline from what is stored, at the width and in the format of a paper; computes nothing.

    \b
    vines figure quickstart --width 85mm
    vines figure paper.fig4 --out fig4.svg --style thesis.mplstyle
    """  # noqa: D301
    from vines.cli._run import read_setting
    from vines.stages import save_figure

    path = save_figure(
        name, out, width=width, dpi=dpi, style=style, overrides=dict(map(read_setting, settings)), study=the_study()
    )
    click.echo(f"wrote {path}  ({path.stat().st_size / 1e3:.0f} kB)")
