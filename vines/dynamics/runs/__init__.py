"""What rooms above need to run the simulator in their own way: tables of parameters and starts, threads, measures."""

from vines.dynamics._ensemble import (
    STATUS_NAMES,
    each_thread,
    measures_of,
    parameter_table,
    start_table,
    threads_allowed,
)
from vines.dynamics._measures import measures_from
from vines.dynamics._room import IN_TURN, TIES, TOGETHER, start_of
from vines.dynamics._simulate import EVENTS_PER_PERIOD, STATUS
from vines.dynamics._slices import slices
from vines.dynamics._start import LARGEST
from vines.dynamics._trajectory import IMPACT, impacts_of
from vines.dynamics._warm_up import timed

__all__ = [
    "EVENTS_PER_PERIOD",
    "IMPACT",
    "IN_TURN",
    "LARGEST",
    "STATUS",
    "STATUS_NAMES",
    "TIES",
    "TOGETHER",
    "each_thread",
    "impacts_of",
    "measures_from",
    "measures_of",
    "parameter_table",
    "slices",
    "start_of",
    "start_table",
    "threads_allowed",
    "timed",
]
