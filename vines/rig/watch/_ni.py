"""A stream from a device of National Instruments, by ``nidaqmx``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from importlib import import_module
from typing import Any

import numpy as np

from vines.errors import RigError, nearest
from vines.packages import need
from vines.rig.ingest import Cells
from vines.rig.watch._channel import channels_of
from vines.rig.watch._stream import Block, Stream, check_rate

__all__ = ["NiSource", "physical_channels"]

_OPTIONS = {"rate": None, "range": "10", "iepe": "", "current": "0.004", "terminal": "DEFAULT"}
_READ = 0.1
"""Seconds of a block."""
_BUFFER = 5.0
"""Seconds that the driver holds for a program that is late."""


def physical_channels(text: str) -> list[str]:
    """Return the channels that a text of NI-DAQmx names.

    Examples
    --------
    >>> physical_channels("Dev1/ai0:2,Dev1/ai7")
    ['Dev1/ai0', 'Dev1/ai1', 'Dev1/ai2', 'Dev1/ai7']
    """
    found: list[str] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\w+)/([A-Za-z]+)(\d+)(?::(?:\2)?(\d+))?\s*", part)
        if match is None:
            raise RigError(f"ni://{text}: {part!r} is no channel of a device, such as Dev1/ai0 or Dev1/ai0:3")
        device, kind, low, high = match[1], match[2], int(match[3]), int(match[4] or match[3])
        step = 1 if high >= low else -1
        found += [f"{device}/{kind}{number}" for number in range(low, high + step, step)]
    return found


class NiSource:
    """Analog inputs of a device.

    Parameters
    ----------
    channels : str
        Such as ``Dev1/ai0:3``.
    options : mapping of str to str
        ``rate`` (needed), ``range`` [V], ``iepe``: inputs whose sensors are fed, such as ``ai1,ai3``, ``current`` [A]
        of these, ``terminal``: a name of ``nidaqmx.constants.TerminalConfiguration``.
    rows : sequence of Cells
        ``channels.tsv``: the field of each row is its input.

    Raises
    ------
    PackageMissingError
        If nidaqmx is not installed.
    RigError
        If an input is not described, or an option is wrong.
    """

    live = True

    def __init__(self, channels: str, options: Mapping[str, str], rows: Sequence[Cells]):
        need("nidaqmx")
        self.where = f"ni://{channels}"
        for key in options:
            if key not in _OPTIONS:
                raise RigError(f"{self.where}: unknown option {key!r}: {nearest(key, _OPTIONS)}")
        given = {**_OPTIONS, **options}
        self._inputs = physical_channels(channels)
        self._rate = check_rate(_number(given["rate"], "rate", self.where), self.where)
        self._range = _number(given["range"], "range", self.where)
        self._current = _number(given["current"], "current", self.where)
        self._terminal = given["terminal"] or "DEFAULT"
        self._iepe = [each for each in (given["iepe"] or "").split(",") if each]
        lacking = [each for each in self._iepe if not any(one.endswith(f"/{each}") for one in self._inputs)]
        if lacking:
            raise RigError(f"{self.where}: iepe names {lacking[0]!r}, which is none of {', '.join(self._inputs)}")
        by_field = {row.cells.get("field"): row for row in rows}
        shared = [row for row in rows if row.name == "*"]
        missing = [each for each in self._inputs if each not in by_field]
        if missing:
            raise RigError(
                f"{self.where}: {', '.join(missing)} is not described; give --channels FILE.tsv with a row whose field "
                f"is {missing[0]}, its name, role, unit (V), sign and sensitivity"
            )
        mine = [by_field[each] for each in self._inputs]
        told = [Cells({"range": f"{self._range:g}", **row.cells}, row.where) for row in mine]
        self._channels = channels_of([*shared, *told])
        self._task: Any = None

    def streams(self) -> Iterator[Stream | None]:
        """Start the task and yield its stream.

        Raises
        ------
        RigError
            If the driver refuses.
        """
        daq, constants = import_module("nidaqmx"), import_module("nidaqmx.constants")
        readers = import_module("nidaqmx.stream_readers")
        self._failure: type[Exception] = import_module("nidaqmx.errors").DaqError
        terminals = constants.TerminalConfiguration
        if self._terminal not in terminals.__members__:
            raise RigError(
                f"{self.where}: terminal {self._terminal!r}: {nearest(self._terminal, terminals.__members__)}"
            )
        try:
            self._task = task = daq.Task()
            for each in self._inputs:
                made = task.ai_channels.add_ai_voltage_chan(
                    each, terminal_config=terminals[self._terminal], min_val=-self._range, max_val=self._range
                )
                if any(each.endswith(f"/{fed}") for fed in self._iepe):
                    made.ai_coupling = constants.Coupling.AC
                    made.ai_excit_src = constants.ExcitationSource.INTERNAL
                    made.ai_excit_voltage_or_current = constants.ExcitationVoltageOrCurrent.USE_CURRENT
                    made.ai_excit_val = self._current
            task.timing.cfg_samp_clk_timing(
                self._rate,
                sample_mode=constants.AcquisitionType.CONTINUOUS,
                samps_per_chan=round(_BUFFER * self._rate),
            )
            # A device takes the nearest rate that it has.
            rate = float(task.timing.samp_clk_rate)
            reader = readers.AnalogMultiChannelReader(task.in_stream)
            task.start()
        except self._failure as error:
            raise self._told(error) from None
        remarks = () if rate == self._rate else (f"{self.where}: the device runs at {rate:.9g} Hz, not {self._rate:g}",)
        run = {"start_utc": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")}
        name = self._inputs[0].partition("/")[0]
        yield Stream(name, self._channels, rate, self._blocks(reader, rate), "<f8", run, remarks=remarks)

    def close(self) -> None:
        """End the task."""
        if self._task is not None:
            self._task.close()
            self._task = None

    def _blocks(self, reader: Any, rate: float) -> Iterator[Block | None]:
        count = max(1, round(_READ * rate))
        values = np.empty((len(self._inputs), count))
        first = 0
        while True:
            try:
                got = int(reader.read_many_sample(values, number_of_samples_per_channel=count, timeout=10.0))
            except self._failure as error:
                raise self._told(error) from None
            yield Block(first, values[:, :got].copy()) if got else None
            first += got

    def _told(self, error: Exception) -> RigError:
        """Return what the driver says in one line; samples that nobody took in time are an error of it too."""
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        return RigError(f"{self.where}: NI-DAQmx: {lines[0] if lines else type(error).__name__}")


def _number(text: str | None, name: str, where: str) -> float:
    if text is None:
        raise RigError(f"{where}: no {name}: write {where}?{name}=51200")
    try:
        value = float(text)
    except ValueError:
        raise RigError(f"{where}: {name} is {text!r}, which is no number") from None
    if not 0 < value < float("inf"):
        raise RigError(f"{where}: {name} is {value:g}, allowed is more than 0")
    return value
