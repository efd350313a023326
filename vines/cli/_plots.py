"""``vines plots [PLOT]``: how a figure may be drawn."""

from __future__ import annotations

import click

from vines.cli._options import show_things


@click.command("plots")
@click.argument("plot", required=False)
@click.option("--markdown", is_flag=True, help="Print the reference of all plots, as docs/reference_plots.md has it.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(plot: str | None, markdown: bool, as_json: bool) -> None:
    """List the plots of figures, those of installed packages too, or the options of PLOT."""
    from vines.stages import describe_plot, list_plots, reference_plots

    if markdown:
        click.echo(reference_plots(), nl=False)
        return
    show_things("plot", list_plots() if plot is None else describe_plot(plot), as_json)
