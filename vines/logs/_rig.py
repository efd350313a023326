"""Write the log of a rig: what its sensors measured and how its base moved, in SI units."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vines.errors import SchemaError
from vines.logs._channels import BASE, FIRST_SENSOR, SAMPLE, SENSOR, Channel, as_rows
from vines.logs._curves import curve_channel, curve_rows
from vines.logs._write import write_rows

__all__ = ["Sensor", "rate_of", "sensor_channels", "write_rig"]

_NEEDED = ("quantity", "unit", "sign", "rate")


@dataclass(frozen=True, eq=False)
class Sensor:
    """What one sensor measured.

    Attributes
    ----------
    samples : numpy.ndarray, shape (n,), structured
        The fields of ``vines.v1.SensorSample``: ``t`` [s], ``value`` in the SI unit that `about` names, ``valid``.
    about : mapping of str to str
        What is measured: ``quantity``, ``unit`` (SI), ``sign`` (which direction is positive) and ``rate`` (samples a
        second) are needed; make, serial number, calibration and the like may follow.
    """

    samples: np.ndarray
    about: Mapping[str, str]


def sensor_channels(sensors: Mapping[str, Mapping[str, str]]) -> dict[str, Channel]:
    """Return the channel of each sensor.

    Parameters
    ----------
    sensors : mapping of str to mapping of str to str
        What is known about each, by its name.

    Raises
    ------
    SchemaError
        If quantity, unit, sign or rate is not stated: vines does not guess.
    """
    channels: dict[str, Channel] = {}
    for place, name in enumerate(sorted(sensors)):
        lacking = [key for key in _NEEDED if not str(sensors[name].get(key, "")).strip()]
        if lacking:
            raise SchemaError(
                f"sensor {name!r} does not state its {', '.join(lacking)}; each needs {', '.join(_NEEDED)}"
            )
        about = {key: str(sensors[name][key]) for key in sorted(sensors[name])}
        channels[name] = Channel(FIRST_SENSOR + place, f"{SENSOR}{name}", SAMPLE, "t", f"sensor {name!r}", about)
    return channels


def write_rig(
    path: str | os.PathLike[str],
    *,
    sensors: Mapping[str, Sensor],
    base: np.ndarray,
    provenance: Mapping[str, object],
    parameters: Mapping[str, float],
    name: str,
    declaration: str | None = None,
    bare: bool = True,
) -> Path:
    """Write a run of a rig as an MCAP log, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    path : path-like
        Where; an existing file is replaced.
    sensors : mapping of str to Sensor
        By name; each gets a channel ``/sensor/<name>``.
    base : numpy.ndarray, shape (n,), structured
        The fields of ``vines.v1.BaseMotion``, SI, sorted by time.
    provenance : mapping
        Where the numbers come from, as in :func:`vines.logs.write_run`.
    parameters : mapping of str to float
        What is known of the rig; the unit belongs into the name.
    name : str
        What the run is called.
    declaration : str, optional
        The text that describes the run, kept as an attachment.
    bare : bool
        Whether the log also carries the curves that viewers draw without vines.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SchemaError
        If an array does not fit its schema or a sensor does not state quantity, unit, sign and rate.
    FileMissingError
        If the folder does not exist.

    Examples
    --------
    >>> import tempfile
    >>> from vines.schema import numpy_dtype
    >>> samples = np.zeros(3, numpy_dtype("vines.v1.SensorSample"))
    >>> samples["t"] = [0.0, 0.1, 0.2]
    >>> about = {"quantity": "displacement", "unit": "m", "sign": "positive to the right", "rate": "10"}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = write_rig(
    ...         f"{folder}/rig.mcap", sensors={"laser": Sensor(samples, about)},
    ...         base=np.zeros(0, numpy_dtype("vines.v1.BaseMotion")), provenance={}, parameters={}, name="rest",
    ...     )
    ...     file.name
    'rig.mcap'
    """
    rows = [as_rows(base, BASE)]
    channels = sensor_channels({key: sensor.about for key, sensor in sensors.items()})
    rows += [as_rows(sensors[key].samples, channel) for key, channel in channels.items()]
    if bare:
        rows += [
            curve_rows(curve_channel(place, each.channel), each.values, rate_of(each.values["t"]))
            for place, each in enumerate(rows[1:])
        ]
    return write_rows(path, rows, {"name": name, "kind": "rig"}, provenance, parameters, declaration)


def rate_of(t: np.ndarray) -> float:
    """Return how many samples there are in a second."""
    return (len(t) - 1) / float(t[-1] - t[0]) if len(t) > 1 and t[-1] > t[0] else 0.0
