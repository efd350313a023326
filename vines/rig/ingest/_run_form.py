"""What ``run.json``, ``rig.json`` and ``channels.tsv`` may say, as types; JSON Schemas in ``schemas/rig`` follow."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

__all__ = ["RECORDING", "CampaignForm", "ChannelRow", "Part", "Proposal", "RunForm", "Stated", "schemas"]

RECORDING = "recording "
"""How the source of a proposal begins that was taken from the recording itself, and so cannot test it."""

_Positive = Meta(gt=0)
_NotNegative = Meta(ge=0)


class Stated(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A number with its standard uncertainty (GUM, coverage factor 1)."""

    value: float
    u: Annotated[float, _NotNegative]


class Proposal(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A value that ``vines rig init`` filled in; once another stands in its place it is none any more."""

    value: Any
    by: str


class Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A stretch of a longer recording: where its run folder is, from this one, and which stretch."""

    of: Annotated[str, Meta(min_length=1, description="Run folder whose raw files are taken; . for its own")]
    begin: Annotated[float, Meta(description="[s] On the clock of that run")]
    end: Annotated[float, Meta(description="[s] Likewise")]


class RunForm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A run of a rig, ``run.json``. SI units. Keys that begin with _ are comments."""

    run_id: Annotated[str, Meta(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", description="Name of the run")]
    start_utc: Annotated[
        str, Meta(pattern=r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z$", description="When it began, ISO 8601 in UTC")
    ]
    protocol: Annotated[
        Literal["dwell", "sweep_up", "sweep_down", "ringdown"],
        Meta(description="One point alone; a point of a sweep with rising or falling parameter; free decay"),
    ]
    f_cmd: Annotated[float, _Positive, Meta(description="[Hz] Commanded frequency; null for a ring-down")] | None
    E_cmd: Annotated[float, _Positive, Meta(description="[m] Commanded base amplitude; null for a ring-down")] | None
    settle: Annotated[float, _NotNegative, Meta(description="[s] Wait at this point before the record")]
    M: Annotated[Stated, Meta(description="[kg] Mass of the oscillator without the ball")]
    m: Annotated[Stated, Meta(description="[kg] Mass of the ball")]
    b: Annotated[Stated, Meta(description="[m] Half length of the cavity less the radius of the ball")]
    ball: Annotated[bool, Meta(description="Whether the ball was in the cavity")]
    temperature_before: Annotated[float, Meta(ge=-50, le=150, description="[deg C] At the springs, before the run")]
    temperature_after: Annotated[float, Meta(ge=-50, le=150, description="[deg C] At the springs, after the run")]
    ringdown: Annotated[tuple[str, ...], Meta(description="run_id of the ring-downs before and after")] = ()
    E_meas: Annotated[Stated | None, Meta(description="[m] Base amplitude as another instrument gave it")] = None
    max_clipped: Annotated[
        float, Meta(ge=0, le=1, description="Largest share of clipped or lost samples that a channel may have")
    ] = 0.01
    max_offset: Annotated[
        float, _NotNegative, Meta(description="[s] How far apart separate recorders may have been started at most")
    ] = 0.05
    materials: Annotated[dict[str, str], Meta(description="Of the ball, the ends, the springs")] = {}
    licence: Annotated[str, Meta(description="Under which the data may be used")] = ""
    doi: Annotated[str, Meta(description="Of the data set")] = ""
    more: Annotated[dict[str, Any], Meta(description="Anything else; kept, not used")] = {}
    overrule: Annotated[
        dict[str, str],
        Meta(
            description="Why this run differs from rig.json or channels.tsv of the campaign, by KEY or CHANNEL.COLUMN"
        ),
    ] = {}
    part: Annotated[
        Part | None, Meta(description="What 'vines rig split' cut out of a longer recording; null for all of it")
    ] = None
    proposed: Annotated[
        dict[str, Proposal], Meta(description="What 'vines rig init' filled in, and from what; nothing to fill in")
    ] = {}


_OF_A_RUN = ("run_id", "start_utc", "overrule", "part")
CampaignForm = msgspec.defstruct(
    "CampaignForm",
    [(each.name, each.type | None, None) for each in msgspec.structs.fields(RunForm) if each.name not in _OF_A_RUN],
    frozen=True,
    forbid_unknown_fields=True,
    kw_only=True,
    namespace={"__doc__": "What all runs of a campaign share, ``rig.json``; each may be left to the runs."},
)
"""``rig.json``: what ``run.json`` may say, any of it."""


class ChannelRow(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A row of ``channels.tsv``: a sensor, how it was recorded, and where its samples are."""

    name: Annotated[str, Meta(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", description="Name of the channel")]
    role: Annotated[
        Literal[
            "base_disp", "base_vel", "base_acc", "lo_disp", "lo_vel", "lo_acc", "ball_cam", "stinger_force",
            "temperature", "sound",
        ],
        Meta(description="What it measures"),
    ]  # fmt: skip
    quantity: Annotated[
        Literal["displacement", "velocity", "acceleration", "force", "temperature", "pressure"],
        Meta(description="Quantity; must fit the role"),
    ]
    dof: Annotated[str, Meta(description="Degree of freedom, such as x1 or e")] = ""
    file: Annotated[str, Meta(min_length=1, description="File below raw/")]
    field: Annotated[str, Meta(min_length=1, description="Name of the channel in that file")]
    unit: Annotated[str, Meta(min_length=1, description="Unit of the numbers in the file")]
    scale: Annotated[
        float, Meta(description="What one count of the file is in that unit, where it holds counts; else empty")
    ] = 1.0
    offset: Annotated[float, Meta(description="What count 0 is in that unit")] = 0.0
    sensitivity: Annotated[
        float | Literal["scaled"],
        Meta(description="Of the calibration sheet; the word scaled where the file holds mechanical units already"),
    ]
    sensitivity_unit: Annotated[str, Meta(description="Such as mV/g, V/mm; empty if scaled")] = ""
    u_sensitivity: Annotated[float, Meta(ge=0, lt=1, description="Relative standard uncertainty of the sensitivity")]
    sign: Annotated[
        Literal["+1", "-1"], Meta(description="+1 if the signal rises for motion to the right, the direction of x1")
    ]
    fs: (
        Annotated[float, _Positive, Meta(description="[Hz] Sampling rate; file to take that of the file")]
        | Literal["file"]
    )
    t0: (
        Annotated[float, Meta(description="[s] First sample on the clock of its recorder; file for what the file says")]
        | Literal["file"]
    ) = 0.0
    range: Annotated[float, _Positive, Meta(description="Largest value that can be recorded, in the unit of the file")]
    group_delay: Annotated[float, _NotNegative, Meta(description="[s] Delay of sensor, conditioner and filters")]
    u_delay: Annotated[float, _NotNegative, Meta(description="[s] Standard uncertainty of the delay")] = 0.0
    high_pass: Annotated[
        float,
        _NotNegative,
        Meta(description="[Hz] Corner of the first-order high-pass (AC or IEPE coupling); 0 for DC"),
    ] = 0.0
    anti_alias: Annotated[float, _Positive, Meta(description="[Hz] Corner of the anti-alias filter")] | None = None
    bits: Annotated[int, _Positive, Meta(description="Of the converter")] | None = None
    recorder: Annotated[str, Meta(description="Which recorder; channels of one share a clock")] = "1"
    sensor: Annotated[str, Meta(description="Make and model")] = ""
    serial: Annotated[str, Meta(description="Serial number")] = ""
    calibrated: Annotated[str, Meta(description="Date of the calibration")] = ""
    dialect: Annotated[
        str,
        Meta(
            description="Layout of a file of text as 'vines rig inspect' shows it, or the parts that it does not find"
        ),
    ] = ""
    overrule: Annotated[
        str,
        Meta(description="What the file says wrongly and why: unit: REASON; fs: REASON; t0: REASON"),
    ] = ""

    @property
    def where(self) -> str:
        """How messages call the channel."""
        return f"{self.name} (raw/{self.file}, {self.field})"


def schemas() -> dict[str, str]:
    """Return the text of each file in ``schemas/rig``, by its name."""
    texts = {}
    for name, kind in (("run", RunForm), ("rig", CampaignForm), ("channels", ChannelRow)):
        form: dict[str, Any] = {"$schema": "https://json-schema.org/draft/2020-12/schema", **msgspec.json.schema(kind)}
        if kind is not ChannelRow:
            form["$defs"][kind.__name__]["patternProperties"] = {"^_": {}}
        texts[f"{name}.schema.json"] = msgspec.json.format(msgspec.json.encode(form), indent=2).decode() + "\n"
    return texts


if __name__ == "__main__":
    from vines.places import shipped

    for file, text in schemas().items():
        place = shipped("schemas") / "rig" / file
        place.parent.mkdir(exist_ok=True)
        place.write_text(text, encoding="utf-8")
