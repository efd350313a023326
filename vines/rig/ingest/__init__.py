"""From a run folder to a recording in SI units on one clock; what a laboratory must state and does not is asked for."""

from vines.rig.ingest._channel_table import ALL, COLUMNS, Cells, channels_text, read_cells, spread_all
from vines.rig.ingest._clipping import clipped_samples, flat_ends
from vines.rig.ingest._init import Written, init_campaign, init_run
from vines.rig.ingest._inspect import channel_facts, draw_file, spark
from vines.rig.ingest._propose import known_channels
from vines.rig.ingest._read_run import Ingested, assemble, read_run
from vines.rig.ingest._run_folder import CAMPAIGN, SUMS, RunFolder, find_runs, raw_sums, read_folder, stated_files
from vines.rig.ingest._run_form import RECORDING, ChannelRow, Part, Proposal, RunForm, Stated
from vines.rig.ingest._template import RUN, json_text, run_readme, table_text
from vines.rig.ingest._tone import find_tone

__all__ = [
    "ALL",
    "CAMPAIGN",
    "COLUMNS",
    "RECORDING",
    "RUN",
    "SUMS",
    "Cells",
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
    "clipped_samples",
    "draw_file",
    "find_runs",
    "find_tone",
    "flat_ends",
    "init_campaign",
    "init_run",
    "json_text",
    "known_channels",
    "raw_sums",
    "read_cells",
    "read_folder",
    "read_run",
    "run_readme",
    "spark",
    "spread_all",
    "stated_files",
    "table_text",
]
