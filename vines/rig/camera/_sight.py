"""The ball as its own sensor saw it, on the clock of the run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from vines.rig.camera._alignment import Alignment, align
from vines.rig.camera._flights import Flights, find_flights
from vines.rig.fit import Train
from vines.rig.recording import Recording, Sampled

__all__ = ["Sight", "see_ball"]

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """Impacts of the ball by a camera or a second laser.

    Attributes
    ----------
    channel : Sampled
        That sensor.
    flights : Flights
        On the clock of the run and with the sign that momentum asks for, as far as the sensors see one ball; else as
        they were recorded.
    alignment : Alignment or None
        None where too few impacts were seen.
    """

    channel: Sampled
    flights: Flights
    alignment: Alignment | None

    @property
    def fits(self) -> bool:
        """Whether it sees the ball that the oscillator answers to."""
        return self.alignment is not None and self.alignment.fits

    def train(self, mu: float) -> Train | None:
        """Return the impacts with the jumps of the oscillator that belong to them, mass ratio `mu`; None if unfit."""
        if not self.fits or self.alignment is None:
            return None
        turn = self.flights.v_after - self.flights.v_before
        return Train(self.flights.t, -mu * turn, np.hypot(self.flights.u_t, self.alignment.u))


def see_ball(recording: Recording, s: complex, omega: float) -> Sight | None:
    """Return what the channel ``ball_cam`` shows; None without one.

    Parameters
    ----------
    recording : Recording
    s : complex
        Of the free oscillation [1/s].
    omega : float
        Of the forcing [rad/s].
    """
    channel, oscillator = recording.role("ball_cam"), recording.role("lo_acc", "lo_disp", "lo_vel")
    if channel is None or oscillator is None:
        return None
    flights = find_flights(channel.times, channel.values, channel.valid, channel.rate)
    alignment = align(flights, oscillator, s, omega)
    if alignment is None or not alignment.fits:
        return Sight(channel, flights, alignment)
    sign, pace = alignment.sign, alignment.pace
    seen = replace(
        flights,
        t=alignment.on_the_run(flights.t),
        u_t=flights.u_t * pace,
        gaps=alignment.on_the_run(flights.gaps),
        x=sign * flights.x,
        v_before=sign * flights.v_before / pace,
        v_after=sign * flights.v_after / pace,
    )
    return Sight(channel, seen, alignment)
