"""``vines rig compare``: a run beside the model."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import click

from vines.cli._study import the_study
from vines.model import PARAMETER_NAMES

_FOLDER = click.Path(path_type=Path)
_COLOURS = {"agree": "green", "pattern_only": "yellow", "disagree": "red", "undecidable": "yellow"}


@click.command("compare")
@click.argument("run", type=_FOLDER)
@click.option("--ringdown", "ring_downs", type=_FOLDER, multiple=True, help="Run folder of a ring-down; repeatable.")
@click.option("--json", "as_json", is_flag=True, help="For machines: the rows of the table comparisons.")
def command(run: Path, ring_downs: tuple[Path, ...], as_json: bool) -> None:
    """Reconstruct the run folder RUN and lay it beside every branch that coexists at its measured parameters.

    The verdict is agree, pattern_only, disagree or undecidable, with the reason. E_n = |measured - model|/(2 u) of
    impact phase, max|x1| and K2/K1 is at most 1 where they agree. Also writes RUN/derived/comparison.json. Exit code 1
    unless the verdict is agree. Of a folder of runs all with the ball are compared, a line each. Parameters calibrated
    on other runs need a pipeline: see docs/rig.md.

    \b
    vines rig compare campaign/runs/01_up
    """  # noqa: D301
    from vines.cli._rig_reconstruct import lost_row, show_runs
    from vines.stages import compare_run, compile_for, each_of, is_campaign

    several = is_campaign(run)
    compile_for("compare", lambda line: click.echo(line, err=True))
    if several:
        one = partial(compare_run, ring_downs=ring_downs, study=the_study())
        rows = [made.rows[0] if made else lost_row(name, why) for name, made, why in each_of(run, one, the_study())]
        rows = [{"verdict": "undecidable", **row} for row in rows]
        show_runs(rows, ["run_id", "verdict", "pattern", "branch", "reason"], as_json)
        raise click.exceptions.Exit(0 if all(row["verdict"] == "agree" for row in rows) else 1)
    made = compare_run(run, ring_downs, study=the_study())
    if as_json:
        click.echo(made.file.read_text("utf-8"), nl=False)
    else:
        _show(made.rows)
        click.echo(f"\nwrote {made.file}")
    raise click.exceptions.Exit(0 if made.found.verdict == "agree" else 1)


def _show(rows: list[dict[str, Any]]) -> None:
    from vines.cli._layout import print_rows
    from vines.cli._rig_reconstruct import with_uncertainty

    first = rows[0]
    click.secho(f"{first['run_id']}: {first['verdict']}", fg=_COLOURS[first["verdict"]], bold=True)
    click.echo(first["reason"])
    click.echo("at " + ", ".join(f"{name} = {first[name]:.6g}" for name in PARAMETER_NAMES) + "\n")
    shown: list[list[object]] = []
    for row in rows:
        if row.get("branch") is None:
            continue
        kind = {None: "", True: " symmetric", False: " asymmetric"}[row["symmetric"]]
        kept = f"{row['holding']:.0%}" if row["holding"] is not None else ""
        for k, (name, what) in enumerate(
            (("phase", "worst impact phase [rad]"), ("max_abs_x1", "max|x1|"), ("kinetic_ratio", "K2/K1"))
        ):
            cells = [
                " ± ".join(with_uncertainty(row[f"{of}{name}"], row[f"u_{of}{name}"])) if row[f"{of}{name}"] else ""
                for of in ("", "model_")
            ]
            error = row[f"E_n_{name}"]
            head = [row["branch"] + kind if k == 0 else "", kept if k == 0 else ""]
            shown.append([*head, what, *cells, "" if error is None else f"{error:.2f}"])
    if shown:
        print_rows(["branch", "shows the pattern", "quantity", "measured", "model", "E_n"], shown, wrap=0)
