"""``vines rig next``: which amplitude and frequency to measure next."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._finite import finite
from vines.cli._study import the_study
from vines.errors import FileMissingError

_KINDS = {"inform": "tells most", "coexist": "branches coexist", "jump": "a jump is near"}


@click.command("next")
@click.argument("source", metavar="FOLDER|PIPELINE")
@click.option("--count", type=click.IntRange(1, 50), default=8, show_default=True, help="Suggestions at most.")
@click.option("--dwells", type=click.IntRange(1, 1000), default=5, show_default=True, help="Dwells at each of them.")
@click.option(
    "--length",
    type=click.FloatRange(min=0),
    callback=finite,
    default=0.0,
    help="Seconds of a dwell; as long as the runs were if left out.",
)
@click.option("--amplitudes", type=(float, float), metavar="FROM TO", help="Range of A; a fifth beyond the runs.")
@click.option("--omegas", type=(float, float), metavar="FROM TO", help="Range of Omega; .4 % beyond the runs.")
@click.option(
    "--png", type=click.Path(dir_okay=False, path_type=Path), help="Draw the plane of A and Omega; also .svg."
)
@click.option("--json", "as_json", is_flag=True, help="For machines.")
def command(
    source: str, count: int, dwells: int, length: float, amplitudes: tuple[float, float] | None,
    omegas: tuple[float, float] | None, png: Path | None, as_json: bool,
) -> None:  # fmt: skip
    """Say which A and Omega to measure next, of a folder of runs or of a pipeline that has reconstructed some.

    Sorted by what dwells there would tell of mu, r, friction, tilt and stiffness (bits of information, and the standard
    uncertainties before and after in words); where branches coexist; and, last, where a jump is near, which a sweep in
    small steps finds. By the model's derivatives at the rig's parameters and what the runs so far measured how well.

    \b
    vines rig next demo/runs --png plane.png
    vines rig next rehearsal --dwells 10 --length 120
    """  # noqa: D301
    import msgspec

    from vines.cli._layout import print_rows
    from vines.stages import compile_for, next_runs, suggestion_rows, table_of

    if png is not None and not png.absolute().parent.is_dir():
        raise FileMissingError(f"{png}: the folder {png.absolute().parent} does not exist; make it first")
    compile_for("compare", lambda line: click.echo(line, err=True))
    found = next_runs(
        source, study=the_study(), count=count, dwells=dwells, length=length, amplitudes=amplitudes, omegas=omegas
    )
    plan = found.plan
    if png is not None:
        found.figure().savefig(png)
    if as_json:
        click.echo(msgspec.json.format(msgspec.json.encode(suggestion_rows(plan), enc_hook=float), indent=1).decode())
        return
    known = plan.known
    click.echo(
        f"from {len(known.runs)} runs: " + ", ".join(f"{k} = {v:.6g}" for k, v in known.params.as_dict().items())
    )
    print_rows(*table_of(plan), wrap=-1)
    for number, one in enumerate(plan.suggestions, 1):
        click.echo(f"{number}. {_KINDS[one.purpose]}: {one.reason}")
        if one.near:
            click.secho(f"   near: {one.near}", fg="yellow")
    for name, reason in found.lost.items():
        click.secho(f"{name} not used: {reason}", fg="red")
    if png is not None:
        click.echo(f"wrote {png}")
