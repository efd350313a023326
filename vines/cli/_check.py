"""``vines check``: do the results reproduce what was published?"""

from __future__ import annotations

import json
import sys

import click


@click.command("check")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(name: str | None, as_json: bool) -> None:
    """Do the results reproduce the published values? One row each; exit 1 when one misses its tolerance.

    The rows come from the stages of kind "check" of the pipeline NAME, or of all pipelines that have been run.
    """
    from vines.cli._layout import print_rows
    from vines.stages import checks

    rows = checks(name)
    if as_json:
        click.echo(json.dumps(rows, indent=2))
    else:
        print_rows(
            ["check", "source", "statement", "published", "ours", "tolerance", "verdict"],
            [
                [
                    r["id"],
                    r["source"],
                    r["statement"],
                    r["published"],
                    r["ours"],
                    r["tolerance"],
                    r["verdict"],
                ]
                for r in rows
            ],
            wrap=2,
        )
        for row in rows:
            if row["remark"] and row["verdict"] != "reproduced":
                click.echo(f"\n{row['id']}: {row['remark']}")
        good = sum(row["verdict"] == "reproduced" for row in rows)
        click.echo(f"\n{good} of {len(rows)} reproduced")
    if any(row["verdict"] == "differs" for row in rows):
        sys.exit(1)
