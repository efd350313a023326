"""``vines status [NAME]``: what is computed, what is stale, and why."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from vines.cli._study import the_study

if TYPE_CHECKING:
    from vines.pipeline import StagePlan


@click.command("status")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(names: tuple[str, ...], as_json: bool) -> None:
    """Say what is computed, what is stale, and why: of the pipelines or collections NAME, or of all.

    One pipeline is told stage by stage, several in a line each.
    """
    from vines.cli._layout import print_rows
    from vines.stages import status_of_each

    plans, unreadable = status_of_each(*names, study=the_study())
    if as_json:
        told: dict[str, object] = {each: [asdict(p) for p in found] for each, found in plans.items()}
        click.echo(json.dumps({**told, **{each: {"error": why} for each, why in unreadable.items()}}, indent=2))
        return
    if len(names) != 1 or names != tuple(plans):
        rows = []
        for each, found in plans.items():
            ready = sum(p.state == "up_to_date" for p in found)
            first = next((f"{p.name}: {p.reason}" for p in found if p.state != "up_to_date"), "up to date")
            rows.append([each, f"{ready} of {len(found)}", first])
        rows += [[each, "", f"cannot be read: {why}"] for each, why in unreadable.items()]
        print_rows(["pipeline", "stages ready", "first to do"], sorted(rows), wrap=2)
        return
    print_rows(
        ["stage", "kind", "state", "points", "failed", "why"],
        [
            [p.name, p.kind, p.state.replace("_", " "), f"{p.done}/{p.wanted}", p.failed or "", _why(p)]
            for p in plans[names[0]]
        ],
        wrap=5,
    )


def _why(plan: StagePlan) -> str:
    """Return the reason, with what else a reader should know of the result."""
    versions = f"computed with {plan.versions}" if plan.versions else ""
    return "; ".join(filter(None, [plan.reason, plan.remark, versions]))
