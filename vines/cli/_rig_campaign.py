"""``vines rig campaign``: run folders of a synthetic sweep."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._finite import finite
from vines.errors import ParameterError


@click.command("campaign")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--from", "first", type=float, callback=finite, default=0.013, show_default=True, help="Least amplitude A = E/b."
)
@click.option("--to", "last", type=float, callback=finite, default=0.023, show_default=True, help="Largest amplitude.")
@click.option("--count", type=click.IntRange(min=1), default=6, show_default=True, help="Amplitudes of a sweep.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of everything that is drawn.")
@click.option("--draw", is_flag=True, help="Draw the imperfections over their ranges; else the rig is a good one.")
@click.option(
    "--warming", type=float, callback=finite, default=1.5, show_default=True, help="Change of temperature [K]."
)
@click.option("--set", "given", multiple=True, metavar="K=V", help="A setting of the rig, e.g. duration=30.")
def command(
    folder: Path, first: float, last: float, count: int, seed: int, draw: bool, warming: float, given: tuple[str, ...]
) -> None:
    """Make a synthetic campaign in FOLDER: run folders of a sweep up and down with ring-downs before, between, after.

    The runs lie in FOLDER/runs, their truth in FOLDER/sealed. The pipeline 'rehearsal' does the same and goes on.

    \b
    vines rig campaign demo --count 4 --set duration=20
    vines rig ingest demo/runs
    """  # noqa: D301
    import numpy as np

    from vines.cli._rig_synth import read_settings
    from vines.rig.synth import make_campaign

    if not 0 < first <= last or (count > 1 and first == last):
        raise ParameterError(f"--from {first:g} --to {last:g}: allowed are 0 < from < to")
    amplitudes = np.linspace(first, last, count).tolist()
    rows = make_campaign(
        folder / "runs", amplitudes=amplitudes, seed=seed, draw=draw, warming=warming, given=read_settings(given)
    )
    size = sum(row["bytes"] for row in rows) / 1e6
    click.echo(f"wrote {len(rows)} runs ({size:.0f} MB) to {folder / 'runs'}, their truth to {folder / 'sealed'}")
    click.echo(f"  vines rig ingest {folder / 'runs'}")
