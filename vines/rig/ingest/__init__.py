"""From a run folder to a recording in SI units on one clock; what a laboratory must state and does not is asked for."""

from vines.rig.ingest._channel_table import channels_text
from vines.rig.ingest._init import Written, init_campaign, init_run
from vines.rig.ingest._inspect import channel_facts, draw_file, spark
from vines.rig.ingest._read_run import Ingested, assemble, read_run
from vines.rig.ingest._run_folder import CAMPAIGN, SUMS, RunFolder, find_runs, raw_sums, read_folder, stated_files
from vines.rig.ingest._run_form import RECORDING, ChannelRow, Part, Proposal, RunForm, Stated
from vines.rig.ingest._tone import find_tone

__all__ = [
    "CAMPAIGN",
    "RECORDING",
    "SUMS",
    "ChannelRow",
    "Ingested",
    "Part",
    "Proposal",
    "RunFolder",
    "RunForm",
    "Stated",
    "Written",
    "assemble",
    "channel_facts",
    "channels_text",
    "draw_file",
    "find_runs",
    "find_tone",
    "init_campaign",
    "init_run",
    "raw_sums",
    "read_folder",
    "read_run",
    "spark",
    "stated_files",
]
