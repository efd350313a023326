"""Curves of a rig that viewers draw without vines: a channel a sensor in a message of ROS 2 that they know.

Foxglove and PlotJuggler draw the protobuf of ``/sensor/<name>`` too; Rerun by itself draws no field of a schema that it
does not know.
"""

from __future__ import annotations

import struct
from functools import lru_cache

import numpy as np

from vines.logs._channels import SENSOR, Channel, Rows, log_times
from vines.logs._form import ROS_LATEST, Form
from vines.logs._thin import extremes
from vines.schema import WireFormat

__all__ = ["CURVE_RATE", "curve_channel", "curve_rows"]

CURVE_RATE = 512.0
"""Samples a second of a curve at most."""
_FIRST = 500
"""Number of the first channel of a curve."""
_ARRAY = b"""std_msgs/MultiArrayLayout layout

float64[] data

================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset

================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
"""


def curve_channel(place: int, sensor: Channel) -> Channel:
    """Return the channel of the curve of a sensor, the `place`-th of its log."""
    name = sensor.topic.removeprefix(SENSOR)
    schema = ("ros2msg", _ARRAY)
    about = {key: sensor.metadata[key] for key in ("quantity", "unit", "sign") if key in sensor.metadata}
    return Channel(
        *(_FIRST + place, f"/curves/{name}", "std_msgs/msg/Float64MultiArray", "t", f"curve {name!r}", about),
        schema=schema,
        encoding="cdr",
    )


@lru_cache(1)
def _layout() -> WireFormat:
    """Return how an array of one number lies in CDR: no dimension, no offset, one number."""
    return Form().put(b"\0\1\0\0" + struct.pack("<III", 0, 0, 1)).align(8).slot("value", "<f8").layout()


def curve_rows(channel: Channel, samples: np.ndarray, rate: float, first: int = 0) -> Rows:
    """Return samples of a sensor as its curve, thinned so that shocks stay in sight.

    Parameters
    ----------
    channel : Channel
        Of :func:`curve_channel`.
    samples : numpy.ndarray, shape (n,), structured
        The fields of ``vines.v1.SensorSample``; those that are not valid are left out.
    rate : float
        How many of them there are in a second, about.
    first : int
        Sequence number of the first message.
    """
    good = samples[(samples["valid"] == 1) & (samples["t"] < ROS_LATEST)]
    kept = good[extremes(good["value"], int(np.ceil(min(rate / CURVE_RATE, max(len(good), 1)))))]
    layout = _layout()
    rows = np.empty(len(kept), np.dtype([("value", "<f8")]))
    rows["value"] = kept["value"]
    return Rows(channel, layout, log_times(kept["t"]), rows, first)
