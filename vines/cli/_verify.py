"""``vines verify``: are the stored results intact and physically consistent?"""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from vines.cli._study import the_study


@click.command("verify")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--recompute",
    type=click.IntRange(min=0),
    default=0,
    metavar="N",
    help="Also compute N random rows again from their provenance and start state.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the draw of rows.")
@click.option("--all", "everything", is_flag=True, help="Also results that no pipeline refers to any more.")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(names: tuple[str, ...], recompute: int, seed: int, everything: bool, as_json: bool) -> None:
    """Are the stored results intact and physically consistent? Whether they agree with the paper asks vines check.

    Checked are the results of the pipelines NAME, or of all that were run: checksums, schemas, provenance, and for
    every stored row what physics says of it, such as energy balance, product of the multipliers, |w| < 1 between
    impacts and the residual. One line for each check; exit code 1 if one fails, with the first row that is wrong.

    \b
    vines verify
    vines verify fig4 --recompute 100
    """  # noqa: D301
    from vines.cli._layout import lines
    from vines.stages import verify

    found = verify(*names, everything=everything, recompute=recompute, seed=seed, study=the_study())
    if as_json:
        rows = [{**asdict(line), "good": line.good} for line in found.lines]
        told = {"good": found.good, "results": found.results, "rows": found.rows, "checks": rows}
        click.echo(json.dumps(told, indent=2))
        raise click.exceptions.Exit(0 if found.good else 1)
    shown = []
    for line in found.lines:
        count = f"{line.failed} of {line.checked}" if line.failed else f"{line.checked}"
        aside = f", {line.skipped} do not apply" if line.skipped else ""
        largest = f"{line.largest:.1e} <= {line.allowed:g}" if line.allowed and line.checked else ""
        verdict = "ok" if line.good else "FAIL"
        shown.append([verdict, line.group, line.name, f"{count} {line.unit}{aside}", largest, line.says])
    head, *rest = lines(["", "of", "check", "checked", "largest defect", "what should hold"], shown, wrap=-1)
    click.secho(head, bold=True)
    for text in rest:
        click.secho(text, fg="red" if text.startswith("FAIL") else None)
    for line in found.lines:
        if line.first:
            click.secho(f"\nFAIL {line.group}, {line.name}: {line.first}", fg="red", err=True)
    bad = sum(not line.good for line in found.lines)
    good = "all hold" if not bad else f"{bad} do not hold"
    click.echo(f"\n{found.rows} rows of {found.results} results, {len(found.lines)} checks: {good}")
    raise click.exceptions.Exit(0 if found.good else 1)
