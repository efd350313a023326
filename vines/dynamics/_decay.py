"""How a disturbance decays: where its energy goes, and when little of it is left."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vines.domains import Number, Numbers, Of, stated
from vines.dynamics._room import room_of
from vines.dynamics._trajectory import Trajectory
from vines.errors import StateError

__all__ = ["Decay", "decay"]


@dataclass(frozen=True, slots=True)
class Decay:
    """Where the energy of an undriven run went.

    Attributes
    ----------
    energy : float
        Energy at the start, in units of M b² omega0², above that of rest: with tilt the balls rest on the lower ends,
        and the oscillator below its place without them.
    impact_share, damper_share, frame_share, ball_share : float
        Shares of it that were lost in impacts and in the damper, and that oscillator and ball have at the end; their
        sum is 1 to rounding. A spring that holds the ball counts with it, a damper beside that spring with the other;
        a mass on a spring beside the ball counts as a ball.
    travel_share : float
        Share lost on the ball's way through the cavity, to a coil or by friction; it belongs to that sum.
    times : tuple of float
        When no more than each of the shares asked for is left for the first time, nan where that is not in the run.
    impacts : int
        Impacts in the run.
    first_impact, last_impact : float
        Times of the first and the last, nan if there is none.
    """

    energy: float
    impact_share: float
    damper_share: float
    frame_share: float
    ball_share: float
    travel_share: float
    times: tuple[float, ...]
    impacts: int
    first_impact: float
    last_impact: float


@stated(run=Of("Trajectory|ParallelRun", how="as vines.simulate returns it"), shares=Numbers(Number(above=0, below=1)))
def decay(run: Trajectory, shares: Sequence[float] = (0.1, 0.01)) -> Decay:
    """Return where the energy of a run without forcing went.

    Parameters
    ----------
    run : Trajectory
        With A = 0.
    shares : sequence of float
        Shares of the energy at the start that the times are wanted of.

    Raises
    ------
    StateError
        If the run is driven, or has no energy at its start.

    Examples
    --------
    >>> from vines.dynamics import simulate
    >>> from vines.model import Params
    >>> found = decay(simulate(Params(mu=0.02, A=0.0), v1=2.0, v2=0.0, periods=20))
    >>> found.impacts, round(2 * found.impact_share, 6), round(found.times[0], 4)
    (54, 0.718833, 114.579)
    """
    if "A" not in run.params.as_dict():
        raise StateError(f"the system {run.params.system.name} has no oscillator of its own whose energy decays")
    if run.params.A != 0:
        raise StateError(f"A is {run.params.A:g}; energy decays where nothing drives: give A = 0")
    whole = run.measures()
    frame, ball = _above_rest(run.params, run.final)
    start = frame + ball - whole.energy_change
    if not start > 0:
        raise StateError("nothing moves at the start; give a velocity that is not 0")
    hits = run.impacts["t"]
    return Decay(
        energy=start,
        impact_share=whole.impact_loss / start,
        damper_share=whole.damper_loss / start,
        frame_share=frame / start,
        ball_share=ball / start,
        travel_share=whole.travel_loss / start,
        times=tuple(_reaches(run, frame + ball, share * start) for share in shares),
        impacts=len(hits),
        first_impact=float(hits[0]) if len(hits) else math.nan,
        last_impact=float(hits[-1]) if len(hits) else math.nan,
    )


def _above_rest(p: Any, state: dict[str, float]) -> tuple[float, float]:
    """Return the energies of the oscillator and of the balls above those at rest.

    With x2'' = -G a ball has the potential mu G x2. Less its least value, which is reached at x1 = -G sum(mu) with
    every ball on its lower end, the sum of all potentials is (x1 + G sum(mu))²/2 and mu |G| for each ball times its way
    down to that end: squares and heights, so that nothing large cancels when little is left.
    """
    values = p.as_dict()
    pull = values.get("G", 0.0)
    beside = values.get("mu_n")
    masses = {name.partition("mu")[2]: mass for name, mass in values.items() if name.partition("_")[0] == "mu"}
    masses.pop("_n", None)
    frame = room_of(p).frame_energy(p, state, pull * sum(masses.values()))
    balls = 0.0
    for ball, mass in masses.items():
        way = values.get(f"beta{ball}", 1.0) + math.copysign(1.0, pull) * (state[f"x2{ball}"] - state["x1"])
        balls += mass * (0.5 * state[f"v2{ball}"] ** 2 + abs(pull) * way)
    if "k3" in values:
        mass, held = (values["mu"], "x2") if beside is None else (beside, "x3")
        square = (state["x1"] - state[held]) ** 2
        balls += mass * square * (0.5 * values["k1"] + 0.25 * values["k3"] * square)
    if beside is not None:
        balls += 0.5 * beside * state["v3"] ** 2
    return frame, balls


def _reaches(run: Trajectory, left: float, level: float) -> float:
    """Return when the energy, which never grows, has fallen to a level: at an impact or inside a flight.

    What there is at a time is what is left at the end and what is lost from then on.
    """
    low, high = run.t_start, run.t_end
    if left > level:
        return math.nan
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        after = run.measures(last=(run.t_end - middle) / run.params.period)
        if left + after.damper_loss + after.impact_loss + after.travel_loss > level:
            low = middle
        else:
            high = middle
