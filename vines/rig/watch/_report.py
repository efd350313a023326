"""What is said of a run once a second."""

from __future__ import annotations

import msgspec

__all__ = ["Level", "Report"]


class Level(msgspec.Struct, frozen=True):
    """A channel since the report before.

    Attributes
    ----------
    unit : str
        Of `rms`, `peak` and `mean`.
    rms, peak, mean : float
        About the mean; largest distance from it; the mean.
    full : float or None
        Largest part of its range that was used, where the range is known.
    clipped : float
        Share of its samples that are at the end of the range, or flat at an end.
    clipped_since : int
        Samples of that kind since the run began.
    """

    unit: str
    rms: float
    peak: float
    mean: float
    full: float | None
    clipped: float
    clipped_since: int


class Report(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=False):
    """What is known of a run at one time; ``None`` where the channels do not tell.

    Attributes
    ----------
    t : float
        Time of the last sample [s].
    lost : int
        Samples that did not arrive.
    levels : dict of str to Level
        By channel.
    E, f, u_f : float or None
        Amplitude of the base [m], its frequency and standard uncertainty [Hz].
    response : float or None
        Amplitude of the oscillator's fundamental [m].
    max_abs_x1 : float or None
        Largest displacement of the oscillator [m].
    impacts : int
        How many were heard.
    rate : float or None
        Impacts in a forcing period.
    pattern : str
        Pattern of the last periods, such as ``1:1``; ``mixed``, ``none``, or empty without a forcing to count by.
    share : float or None
        Part of these periods that show it; of a mixed one, that show the most frequent.
    periods : int
        How many they are.
    phases : dict of str to float
        Median phase of the base at the impacts on L and R of the last second [rad].
    r : float or None
        Median restitution of the last impacts, by the displacement.
    settled : bool
        Whether nothing changes any more.
    wait : float or None
        Seconds until it is, where the decay tells.
    why : str
        In words.
    since : float
        When the forcing changed last [s].
    drift : dict of str to float
        Change a minute of E, f, response (relative) and r, where it stands out of the scatter.
    remarks : list of str
        What is wrong: clipping, lost samples, a base that does not move.
    """

    t: float
    lost: int
    levels: dict[str, Level]
    E: float | None
    f: float | None
    u_f: float | None
    response: float | None
    max_abs_x1: float | None
    impacts: int
    rate: float | None
    pattern: str
    share: float | None
    periods: int
    phases: dict[str, float]
    r: float | None
    settled: bool
    wait: float | None
    why: str
    since: float
    drift: dict[str, float]
    remarks: list[str]
