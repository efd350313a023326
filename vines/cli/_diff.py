"""``vines diff A B``: how two results differ."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from vines.cli._finite import finite
from vines.cli._study import the_study


@click.command("diff")
@click.argument("a", metavar="A")
@click.argument("b", metavar="B")
@click.option(
    "--rtol", type=click.FloatRange(min=0), callback=finite, default=1e-9, show_default=True, help="Relative tolerance."
)
@click.option(
    "--atol", type=click.FloatRange(min=0), callback=finite, default=0.0, show_default=True, help="Absolute tolerance."
)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(a: str, b: str, rtol: float, atol: float, as_json: bool) -> None:
    """Compare two results of a stage: what was asked for, and the values, row by row.

    A and B are <pipeline>.<stage> (its result now), the first letters of a key (see 'vines gc', or the folders below
    data/results), or the folder of a result. Points are matched by the values of their axes, other rows by number.
    Exit code 1 if they differ by more than the tolerance |a - b| <= atol + rtol max(|a|, |b|).
    """
    from vines.stages import diff

    found = diff(a, b, rtol=rtol, atol=atol, study=the_study())
    if as_json:
        click.echo(json.dumps({**asdict(found), "same": found.same}, indent=2))
    else:
        click.echo(f"asked for: {found.parameters or 'the same'}")
        for table in found.tables:
            only = "".join(
                f", {count} only in {side}" for side, count in (("A", table.only_a), ("B", table.only_b)) if count
            )
            click.echo(f"{table.name}: {table.matched} rows in both{only}")
            for column in table.columns:
                most = "" if column.largest is None else f", largest difference {column.largest:.3g}"
                click.echo(f"  {column.name}: {column.differ} differ{most}, first at {column.first}")
        click.echo("the same within the tolerance" if found.same else "different")
    raise click.exceptions.Exit(0 if found.same else 1)
