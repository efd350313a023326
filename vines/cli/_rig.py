"""``vines rig``: measured data in, an honest verdict out. Its commands are imported when they are called."""

from __future__ import annotations

import click

from vines.cli import LazyGroup

COMMANDS = {
    "synth": ("vines.cli._rig_synth", "Make a run folder of a synthetic rig, its truth sealed."),
}


@click.group("rig", cls=LazyGroup, known=COMMANDS)
def command() -> None:
    """Measured data of a rig: look at it, ingest it, or rehearse with a synthetic one.

    \b
    vines rig init my_run              a template to fill in
    vines rig inspect recording.tdms   what is in this file?
    vines rig ingest my_run            into the catalogue; 'vines view' shows it
    """  # noqa: D301
