"""A channel that is watched: what one of its numbers is in SI, as far as that is stated."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vines.errors import RigError, nearest
from vines.rig.ingest import ALL, COLUMNS, Cells, spread_all
from vines.rig.recording import ROLES
from vines.rig.units import si_factor, volts_per_unit

__all__ = ["Channel", "channels_of"]

_NEEDED = {
    "name": "no name",
    "role": f"no role: one of {', '.join(ROLES)}",
    "unit": "no unit of its numbers",
    "sign": "no sign: +1 if the signal rises for motion to the right, else -1",
}


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel that is watched.

    Attributes
    ----------
    name, role : str
        Its name, and one of :data:`vines.rig.ROLES`.
    unit : str
        Unit of its numbers.
    quantity, si : str
        What the watched values are, and their unit: that of the role, or volts where no sensitivity is stated.
    factor, offset : float
        Watched value = factor * number + offset; positive to the right.
    range : float or None
        Largest number that can be recorded.
    delay : float
        Delay of sensor and filters [s].
    high_pass : float
        Corner of a first-order high-pass [Hz], 0 for none.
    cells : mapping of str to str
        All that is stated of it, as ``channels.tsv`` has it.
    """

    name: str
    role: str
    unit: str
    quantity: str
    si: str
    factor: float
    offset: float
    range: float | None
    delay: float
    high_pass: float
    cells: Mapping[str, str]

    @property
    def calibrated(self) -> bool:
        """Whether its values are those of its role."""
        return (self.quantity, self.si) == ROLES[self.role]

    @property
    def about(self) -> dict[str, str]:
        """What the log says of its values, but for the rate."""
        told = {key: self.cells[key] for key in ("sensor", "serial", "dof", "calibrated") if key in self.cells}
        return {"quantity": self.quantity, "unit": self.si, "sign": "positive to the right", "role": self.role, **told}


def channels_of(rows: Sequence[Cells]) -> tuple[Channel, ...]:
    """Return the channels that rows of ``channels.tsv`` describe; cells of a row ``*`` hold for all.

    To be watched a channel needs name, role, unit and sign; what ``ingest`` asks for beyond may come later.

    Raises
    ------
    RigError
        If one of these is missing, or what is stated cannot be; one line.
    """
    for row in rows:
        for key in row.cells:
            if key not in COLUMNS:
                raise RigError(f"{row.where}: unknown entry {key!r}: {nearest(key, COLUMNS)}")
    found = tuple(_channel(row) for row in spread_all(rows))
    if not found:
        raise RigError(f"{rows[0].where if rows else 'the source'}: no channels are described")
    names = [each.name for each in found]
    for name in names:
        if names.count(name) > 1:
            raise RigError(f"two channels are called {name!r}; names must differ")
    return found


def _channel(row: Cells) -> Channel:
    cells, where = row.cells, row.where
    for key, why in _NEEDED.items():
        if not cells.get(key):
            raise RigError(f"{where}: {why}")
    name, role, unit = cells["name"], cells["role"], cells["unit"]
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", name) or name == ALL:
        raise RigError(f"{where}: {name!r} is no name of a channel; allowed are letters, digits, and _ . - inside")
    if role not in ROLES:
        raise RigError(f"{where}: role {role!r} of {name} is not known: {nearest(role, ROLES)}")
    if cells["sign"] not in ("+1", "1", "-1"):
        raise RigError(f"{where}: sign {cells['sign']!r} of {name}, allowed are +1 and -1")
    try:
        quantity, factor = si_factor(unit)
        factor, quantity, si = _scaled(cells, quantity, factor)
    except RigError as unfit:
        raise RigError(f"{where}: {name}: {unfit}") from None
    sign = -1.0 if cells["sign"] == "-1" else 1.0
    limit = _number(row, "range", 0.0)
    for key in ("range", "group_delay", "high_pass"):
        if _number(row, key, 0.0) < 0:
            raise RigError(f"{where}: {key} of {name} is {cells[key]}, allowed is 0 and more")
    return Channel(
        name=name,
        role=role,
        unit=unit,
        quantity=quantity,
        si=si,
        factor=sign * factor * _number(row, "scale", 1.0),
        offset=sign * factor * _number(row, "offset", 0.0),
        range=limit or None,
        delay=_number(row, "group_delay", 0.0),
        high_pass=_number(row, "high_pass", 0.0),
        cells=cells,
    )


def _scaled(cells: Mapping[str, str], quantity: str, factor: float) -> tuple[float, str, str]:
    """Return what one unit is, its quantity and unit, by the sensitivity if there is one."""
    wanted, si = ROLES[cells["role"]]
    if quantity == wanted:
        return factor, wanted, si
    if quantity == "voltage" and cells.get("sensitivity", "scaled") != "scaled":
        try:
            sensitivity = float(cells["sensitivity"])
        except ValueError:
            raise RigError(f"sensitivity is {cells['sensitivity']!r}, which is no number") from None
        measured, volts = volts_per_unit(sensitivity, cells.get("sensitivity_unit", ""))
        if measured != wanted:
            raise RigError(f"{cells['sensitivity_unit']} is of a sensor of {measured}, but {cells['role']} is {wanted}")
        return factor / volts, wanted, si
    if quantity == "voltage":
        return factor, "voltage", "V"
    raise RigError(f"{cells['unit']} is a {quantity}, but {cells['role']} is a {wanted} [{si}]")


def _number(row: Cells, key: str, default: float) -> float:
    text = row.cells.get(key)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise RigError(f"{row.where}: {key} of {row.name} is {text!r}, which is no number")
    return value
