"""``vines rig``: measured data in, an honest verdict out. Its commands are imported when they are called."""

from __future__ import annotations

import click

from vines.cli._app import LazyGroup

COMMANDS = {
    "init": ("vines.cli._rig_init", "Write a commented template of a run folder."),
    "inspect": ("vines.cli._rig_inspect", "Show what a raw file holds: channels, units, rates, gaps, clipping."),
    "formats": ("vines.cli._rig_formats", "List the formats of recordings that can be read."),
    "ingest": ("vines.cli._rig_ingest", "Read run folders into the catalogue and as MCAP logs."),
    "split": ("vines.cli._rig_split", "Make a run of each dwell of a recording; raw files stay where they are."),
    "reconstruct": ("vines.cli._rig_reconstruct", "Bring a run to the quantities of the model, with uncertainties."),
    "compare": ("vines.cli._rig_compare", "Lay a run beside the branches of the model that coexist: the verdict."),
    "watch": ("vines.cli._rig_watch", "Watch a run while it goes on: log it, show it, say how it goes."),
    "next": ("vines.cli._rig_next", "Say which amplitude and frequency to measure next, and why."),
    "report": ("vines.cli._rig_report", "Write a page about a campaign: set-up, calibration, verdicts, budgets."),
    "synth": ("vines.cli._rig_synth", "Make a run folder of a synthetic rig, its truth sealed."),
    "campaign": ("vines.cli._rig_campaign", "Make a synthetic sweep up and down with ring-downs."),
}


@click.group("rig", cls=LazyGroup, known=COMMANDS)
def command() -> None:
    """Measured data of a rig: look at it, ingest it, or rehearse with a synthetic one.

    \b
    vines rig init my_run              a template to fill in
    vines rig inspect recording.tdms   what is in this file?
    vines rig formats                  which files can be read
    vines rig ingest my_run            into the catalogue; 'vines view' shows it
    vines rig split staircase          a run of each dwell of a recording
    vines rig reconstruct my_run       omega0, A, mu, r, impacts, pattern, with uncertainties
    vines rig watch listen://5555      a run while it goes on
    vines rig compare my_run           agree, pattern_only, disagree or undecidable, with the reason
    vines rig next my_runs             which amplitude and frequency to measure next, and why
    vines rig report my_runs           one page about the campaign
    """  # noqa: D301
