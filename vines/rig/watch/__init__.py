"""A run while it goes on: where its samples come from, and what they say of it once a second."""

from vines.rig.watch._channel import Channel, channels_of
from vines.rig.watch._folder import STEADY, FolderSource, described_file
from vines.rig.watch._monitor import PERIODS, Monitor
from vines.rig.watch._ni import NiSource, physical_channels
from vines.rig.watch._open import open_source
from vines.rig.watch._report import Level, Report
from vines.rig.watch._run_folder import LoggedRun
from vines.rig.watch._settling import Settling, settling
from vines.rig.watch._socket import MAGIC, SocketSource
from vines.rig.watch._stream import Block, Refusal, Source, Stream
from vines.rig.watch._synth import SynthSource

__all__ = [
    "MAGIC",
    "PERIODS",
    "STEADY",
    "Block",
    "Channel",
    "FolderSource",
    "Level",
    "LoggedRun",
    "Monitor",
    "NiSource",
    "Refusal",
    "Report",
    "Settling",
    "SocketSource",
    "Source",
    "Stream",
    "SynthSource",
    "channels_of",
    "described_file",
    "open_source",
    "physical_channels",
    "settling",
]
