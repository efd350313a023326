"""From a run folder to a recording in SI units on one clock; what a laboratory must state and does not is asked for."""

from vines.rig.ingest._inspect import channel_facts, draw_file, spark
from vines.rig.ingest._read_run import Ingested, assemble, read_run
from vines.rig.ingest._run_folder import SUMS, channels_text, find_runs, raw_sums, read_folder
from vines.rig.ingest._run_form import ChannelRow, RunForm, Stated
from vines.rig.ingest._template import write_template
from vines.rig.ingest._tone import find_tone

__all__ = [
    "SUMS",
    "ChannelRow",
    "Ingested",
    "RunForm",
    "Stated",
    "assemble",
    "channel_facts",
    "channels_text",
    "draw_file",
    "find_runs",
    "find_tone",
    "raw_sums",
    "read_folder",
    "read_run",
    "spark",
    "write_template",
]
