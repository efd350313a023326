"""``vines kinds [KIND]``: what a stage may be."""

from __future__ import annotations

import click

from vines.cli._options import show_things


@click.command("kinds")
@click.argument("kind", required=False)
@click.option("--markdown", is_flag=True, help="Print the reference of all kinds, as docs/reference_kinds.md has it.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(kind: str | None, markdown: bool, as_json: bool) -> None:
    """List the kinds of stages, those of installed packages too, or the options of KIND."""
    from vines.stages import describe_kind, list_kinds, reference_kinds

    if markdown:
        click.echo(reference_kinds(), nl=False)
        return
    show_things("kind", list_kinds() if kind is None else describe_kind(kind), as_json)
