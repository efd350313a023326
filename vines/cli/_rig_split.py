"""``vines rig split``: a recording that dwells at several levels, as runs."""

from __future__ import annotations

from pathlib import Path

import click

from vines.cli._finite import finite

_PATH = click.Path(path_type=Path)


@click.command("split")
@click.argument("run", type=_PATH)
@click.option("--out", type=_PATH, help="Where the run folders go; beside RUN if left out.")
@click.option(
    "--settle",
    type=click.FloatRange(min=0),
    callback=finite,
    default=30.0,
    show_default=True,
    help="Seconds left out at the begin of each dwell, less what RUN says it settled before the first.",
)
@click.option(
    "--shortest", type=click.IntRange(min=8), default=20, show_default=True, help="Forcing periods that must be left."
)
@click.option("--json", "as_json", is_flag=True, help="For machines: one object a dwell.")
def command(run: Path, out: Path | None, settle: float, shortest: int, as_json: bool) -> None:
    """Find the dwells of the run folder RUN, and make a run folder RUN_1, RUN_2, ... of each.

    They refer to the raw files of RUN, which stay where they are; their SHA-256 is noted with each. A second call finds
    them there and changes nothing.

    \b
    vines rig split staircase
    vines rig reconstruct staircase_2
    """  # noqa: D301
    from vines.rig import split_run

    pieces = split_run(run, out, settle=settle, shortest=shortest)
    if as_json:
        import msgspec

        rows = [
            {
                "begin": piece.begin,
                "end": piece.dwell.end,
                "steady_from": piece.dwell.begin,
                "E": piece.dwell.size,
                "folder": None if piece.folder is None else str(piece.folder),
                "made": piece.made,
            }
            for piece in pieces
        ]
        click.echo(msgspec.json.format(msgspec.json.encode(rows), indent=1).decode())
        return
    for piece in pieces:
        dwell = piece.dwell
        told = f"E = {1e3 * dwell.size:.4g} mm from {dwell.begin:.1f} to {dwell.end:.1f} s"
        if piece.folder is None:
            click.echo(f"{told}: left out, too little is left after the settling")
        else:
            state = "wrote" if piece.made else "is there already:"
            click.echo(f"{told}: {state} {piece.folder}, from {piece.begin:.1f} s on")
