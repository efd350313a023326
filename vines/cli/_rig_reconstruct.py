"""``vines rig reconstruct``: a run brought to the quantities of the model."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vines.cli._study import the_study

if TYPE_CHECKING:
    from vines.stages import Derived

_FOLDER = click.Path(path_type=Path)


@click.command("reconstruct")
@click.argument("run", type=_FOLDER)
@click.option(
    "--ringdown", "ring_downs", type=_FOLDER, multiple=True, help="Run folder of a ring-down; may be repeated."
)
@click.option("--json", "as_json", is_flag=True, help="For machines: the row of the table reconstructions.")
def command(run: Path, ring_downs: tuple[Path, ...], as_json: bool) -> None:
    """Bring the run folder RUN to the quantities of the model, each with its standard uncertainty.

    Ring-downs are those that run.json names, else the nearest before and after, among the run folders beside RUN.
    Writes RUN/derived/reconstruction.json and RUN/derived/rig_impacts.parquet. Exit code 1 if a gate or check fails.
    Of a folder of runs all with the ball are reconstructed, a line each; what is wrong with one leaves the others.

    \b
    vines rig reconstruct campaign/runs/01_up
    vines rig reconstruct my_run --ringdown free_1 --ringdown free_2
    """  # noqa: D301
    from vines.stages import each_of, is_campaign, reconstruct_run

    if is_campaign(run):
        one = partial(reconstruct_run, ring_downs=ring_downs, study=the_study())
        rows = [made.row if made else lost_row(name, why) for name, made, why in each_of(run, one, the_study())]
        show_runs(rows, ["run_id", "pattern", "accepted", "r", "failed"], as_json)
        raise click.exceptions.Exit(0 if all(row["accepted"] for row in rows) else 1)
    made = reconstruct_run(run, ring_downs, study=the_study())
    if as_json:
        click.echo(made.files[0].read_text("utf-8"), nl=False)
    else:
        _show(made)
    raise click.exceptions.Exit(0 if made.found.accepted else 1)


def lost_row(name: str, reason: str) -> dict[str, Any]:
    """Return what is said of a run that cannot be used."""
    return {"run_id": name, "status": "failed", "reason": reason, "accepted": False}


def show_runs(rows: list[dict[str, Any]], columns: list[str], as_json: bool) -> None:
    """Show a row for each of several runs, and the reasons of those that cannot be used."""
    import msgspec

    from vines.cli._layout import print_rows

    if as_json:
        click.echo(msgspec.json.format(msgspec.json.encode(rows, enc_hook=float), indent=1).decode())
        return
    shown = []
    for row in rows:
        cells = [row.get(name) for name in columns]
        shown.append(
            ["" if cell is None else f"{cell:.5g}" if isinstance(cell, float) else str(cell) for cell in cells]
        )
    print_rows(columns, shown, wrap=-1)
    for row in rows:
        if row.get("status") == "failed":
            click.secho(f"{row['run_id']} failed: {row['reason']}", fg="red")


def _show(made: Derived) -> None:
    from vines.cli._layout import print_rows
    from vines.rig import QUANTITIES

    found, row = made.found, made.row
    click.echo(
        f"{row['run_id']} ({row['protocol']}, {row['temperature']:.2f} degC): {row['pattern']} in "
        f"{row['fraction']:.1%} of {row['periods']} periods, {row['impacts']} impacts, {row['suspect']} suspect, "
        f"{row['pruned']} pulses were none"
    )
    click.echo(f"omega0 and lam by {', '.join(made.ring_downs)}\n")
    rows = []
    for name, (unit, meaning) in QUANTITIES.items():
        if row[name] is not None:
            value, u = with_uncertainty(row[name], row[f"u_{name}"])
            rows.append([name, value, u, "" if unit == "1" else unit, meaning])
    print_rows(["quantity", "value", "u", "unit", "meaning"], rows, wrap=-1)
    click.echo("")
    gates = [
        ["ok" if gate.passed else "FAIL", gate.name, gate.text.split(": ")[0] if gate.passed else gate.text]
        for gate in found.findings
    ]
    print_rows(["", "gate or check", "what was found"], gates, wrap=-1)
    click.secho("\naccepted" if found.accepted else "\nnot accepted", fg="green" if found.accepted else "red")
    click.echo(f"wrote {', '.join(path.name for path in made.files)} to {made.files[0].parent}")


def with_uncertainty(value: float, u: float) -> tuple[str, str]:
    """Return a number and its standard uncertainty as texts, two digits of the latter.

    Examples
    --------
    >>> with_uncertainty(0.6497056, 0.0008376), with_uncertainty(2.2487e-4, 3.7e-7), with_uncertainty(2.0, 0.0)
    (('0.64971', '0.00084'), ('0.22487e-3', '0.00037e-3'), ('2', '0'))
    """
    if not u > 0 or not math.isfinite(u):
        return f"{value:.6g}", f"{u:.2g}"
    power = 3 * math.floor(math.log10(abs(value)) / 3 + 1 / 3) if 0 < abs(value) < 1e-2 else 0
    scale = 10.0**-power
    digits = max(0, 1 - math.floor(math.log10(u * scale)))
    tail = f"e{power:d}" if power else ""
    return f"{value * scale:.{digits}f}{tail}", f"{u * scale:.{digits}f}{tail}"
