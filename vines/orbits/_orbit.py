"""A periodic orbit: its impacts and everything that is known about it, whatever its word."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics import Measures
from vines.dynamics.kernels import after_impact, constants, room_of
from vines.dynamics.kernels import rows as col
from vines.dynamics.runs import IMPACT
from vines.html import html_table
from vines.model import V1, V2, X2, Word
from vines.orbits._budget import orbit_rows
from vines.orbits._values import marks_of

__all__ = ["SPELL", "Orbit", "short_hash"]

Floats = npt.NDArray[np.float64]

SPELL = np.dtype(
    [("contact", "i8"), ("side", "i1"), ("impacts", "i8")]
    + [(name, "f8") for name in ("t_start", "t_release", "phase_start", "phase_release", "x1", "v1")]
    + [(name, "f8") for name in ("slowest", "least_force", "falls")]
)
"""A spell of sticking; see `Orbit.spells`."""

_NO_SPELLS = np.empty(0, dtype=SPELL)
_NO_SPELLS.setflags(write=False)


def short_hash(*parts: object) -> str:
    """Return 12 hexadecimal digits of the SHA-256 of the parts' texts.

    Examples
    --------
    >>> short_hash("LR", 0.02)
    'e1a2a4d919e9'
    """
    return hashlib.sha256("|".join(str(part) for part in parts).encode()).hexdigest()[:12]


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic solution, stable or not, admissible or not. All values are dimensionless.

    Where the ball sticks (`spells`), the impacts of the chatter before count as one, the first of them.

    The first impact is that of the canonical word (if its letters repeat, the one of least phase); times are those of
    a forcing of phase zero at t = 0, the first in [0, T).

    Attributes
    ----------
    word : Word
    params : Params, or those of another system
    t : (N,) float array
        Times of the impacts over one period pT.
    states : (N, 4) float array
        x1, v1, x2, v2 just before each impact; with a mass beside the ball x3, v3 too.
    jacobians : (N, d, d) float array
        Jacobian of the map from each impact to the next in (v1, v2, x2, t), d = 4; of another system the tangent map
        from just after it to just after the next, as `vines.dynamics.tangent_map` gives it.
    multipliers : (d,) complex array
        Floquet multipliers over pT, the largest modulus first.
    half_multipliers : (d,) complex array or None
        Multipliers of the half map of a symmetric orbit; `multipliers` are their squares.
    symmetric : bool
        Whether the orbit is its own mirror image.
    admissible : bool
        Whether |w| < 1 strictly between the impacts, certified, and every impact comes from inside the cavity.
    min_clearance : float
        Least distance of a turning point of w to the wall it points at, negative beyond it; 2 if no flight turns.
    violation_time, violation_side : float, int
        The first contact between the impacts, nan and 0 if there is none.
    residual : float
        Largest difference of the end of a flight, flown afresh from each impact, to the next stored state.
    measures : Measures
        Energy measures and energy budget over one period pT, in closed form.
    remark : str
        What the search has to say, such as how many other solutions there are.
    spells : structured array, shape (K,)
        Spells of sticking, one for each contact of the word with a star: `contact`, its place in the word; `side`;
        `impacts` of the chatter that were followed one by one; times and phases [rad] at which the chatter accumulates
        and the ball is let go (`t_start`, `t_release`, `phase_start`, `phase_release`; of several balls those of the
        last merge, and where it is kicked off or struck if it is not let go); `x1` and `v1` at the release;
        and how near the spell is to its end as a family: `slowest`, the least speed of an impact of the chatter that a
        faster one follows (inf if none), `least_force`, the least contact force at a minimum within the spell (inf if
        none), and `falls`, the rate at which the force falls at the release.
    instant : (2 + 2 balls,) float array or None
        Of balls in parallel that stick: x1, v1, and x2, v2 of each, after all that happens at the first contact.
    struck : (N, 2) float array or None
        Of balls in parallel that stick: v1, v2 just after each impact, whatever else is struck at that instant.
    release : object or None
        Of orbits that stick, but those of the VI-NES and the impact pair: the release from which the orbit was run.
    """

    word: Word
    params: Any
    t: Floats
    states: Floats
    jacobians: Floats
    multipliers: npt.NDArray[np.complex128]
    half_multipliers: npt.NDArray[np.complex128] | None
    symmetric: bool
    admissible: bool
    min_clearance: float
    violation_time: float
    violation_side: int
    residual: float
    measures: Measures
    remark: str = ""
    spells: npt.NDArray[np.void] = field(default_factory=lambda: _NO_SPELLS)
    instant: Floats | None = field(default=None, repr=False)
    struck: Floats | None = field(default=None, repr=False)
    release: Any = field(default=None, repr=False)

    @property
    def name(self) -> str:
        """The type n:m/pT."""
        return self.word.name

    @property
    def alias(self) -> str:
        """The paper's label of the type."""
        return self.word.alias

    @property
    def period(self) -> float:
        """The period pT."""
        return self.word.p * self.params.period

    @property
    def side(self) -> npt.NDArray[np.int8]:
        """The wall of each impact, +1 for L and -1 for R, shape (N,)."""
        return np.array(self.word.sides, dtype=np.int8)

    @property
    def w_dot(self) -> Floats:
        """Relative velocity w' = v1 - v2 just before each impact, shape (N,)."""
        return self.states[:, V1] - self.states[:, V2]

    @property
    def phase(self) -> Floats:
        """Phase of the forcing at each impact, Omega t modulo 2 pi [rad], shape (N,)."""
        return (getattr(self.params, "Omega", 1.0) * self.t) % (2 * np.pi)

    @property
    def flight_times(self) -> Floats:
        """Time from each impact to the next, the last back to the first, shape (N,)."""
        return np.diff(self.t, append=self.t[0] + self.period)

    @property
    def max_multiplier(self) -> float:
        """Largest modulus of a multiplier over pT."""
        return float(abs(self.multipliers[0]))

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return self.max_multiplier < 1

    @property
    def energy_imbalance(self) -> float:
        """What base work less damper and impact losses leaves over, relative to the base work: rounding."""
        m = self.measures
        lost = m.damper_loss + m.impact_loss + m.travel_loss
        return (m.base_work - lost) / max(abs(m.base_work), lost)

    @cached_property
    def orbit_id(self) -> str:
        """Name of the orbit, from its word, its parameters and its impacts to 1e-8."""
        coarse = np.round(np.column_stack([self.t, self.states]), 8) + 0.0
        return short_hash(self.word, *self.params.as_dict().values(), coarse.tolist())

    @property
    def impacts(self) -> npt.NDArray[np.void]:
        """The impacts as a structured array with the fields of `Trajectory.impacts`, shape (N,)."""
        beside = room_of(self.params).beside
        out = np.empty(len(self.t), dtype=[*IMPACT.descr, *((name, "f8") for name in beside)] if beside else IMPACT)
        for name, values in zip(beside, self.states.T[4:], strict=True):
            out[name] = values
        out["t"], out["side"], out["w_dot"], out["phase"] = self.t, self.side, self.w_dot, self.phase
        out["x1"], out["v1"], out["x2"], out["v2"] = self.states[:, :4].T
        out["v1_after"], out["v2_after"] = self._after().T
        out["index"] = np.arange(len(self.t))
        return out

    def _after(self) -> Floats:
        """Return v1, v2 just after each impact (paper, eq. (12)), shape (N, 2)."""
        if self.struck is not None:
            return self.struck
        law = room_of(self.params).law(self.params, np.maximum(self.word.balls, 1))
        return np.column_stack(after_impact(law, self.states[:, V1], self.states[:, V2]))

    def start(self) -> dict[str, float]:
        """Return a state just after the first impact from which `vines.simulate` follows the orbit.

        Returns
        -------
        dict
            The coordinates of the system (x1, v1, x2, v2) and t: arguments of `vines.simulate`.
        """
        if self.instant is not None:
            x1, v1, *balls = self.instant.tolist()
            (x2, v2), more = balls[:2], [1.0, 0.0, 0.0, *balls]
        else:
            (x1, _, x2, _, *beside), (v1, v2) = self.states[0].tolist(), self._after()[0].tolist()
            more = [*self._balls(), *beside]
        at = room_of(self.params).leave(self.params, (x1, v1, x2, v2), float(self.phase[0]), more)
        return {**at, "t": float(self.t[0])}

    def _balls(self) -> list[float]:
        """Return what a row of an event has behind x1 … v2 where something has numbers, just after the first impact."""
        if self.params.system.modes:
            t, states = self.t.copy(), self.states.copy()  # read-only ones would be another type to the kernel
            rows = orbit_rows(constants(self.params), self.period, marks_of(self.word), t, states)
            return rows[0, col.ROW :].tolist()
        numbers, after, G = np.maximum(self.word.balls, 1), self._after(), getattr(self.params, "G", 0.0)
        found = [float(numbers[0]), 0.0, 0.0]
        for ball in range(1, getattr(self.params, "balls", 0) + 1):
            # Its last impact is that of the repetition before, but of the ball that hits first.
            k = 0 if numbers[0] == ball else int(np.flatnonzero(numbers == ball)[-1])
            since = self.t[0] + self.period - self.t[k] if k else 0.0
            v2 = after[k, 1]
            found += [float(self.states[k, X2] + since * (v2 - 0.5 * G * since)), float(v2 - G * since)]
        return found

    def __str__(self) -> str:
        kind = [
            "symmetric" if self.symmetric else "asymmetric",
            "stable" if self.stable else "unstable",
            "admissible"
            if self.admissible
            else f"inadmissible (meets side {self.violation_side:+d} at t = {self.violation_time:.6g})",
        ]
        return (
            f"{self.name} ({self.word}) at {self.params}: {', '.join(kind)}, "
            f"largest multiplier {self.max_multiplier:.6g}, residual {self.residual:.1e}"
        )

    def __repr__(self) -> str:
        return f"<Orbit {self}>"

    def _repr_html_(self) -> str:
        """Return the orbit as a small table, which a notebook shows."""
        m, moves = self.measures, np.isfinite(self.measures.kinetic_ratio)  # a shaken cavity has no oscillator
        return html_table(
            f"{self.name} ({self.word})",
            {
                "parameters": self.params,
                "period": self.period,
                "symmetric": self.symmetric,
                "stable": self.stable,
                "admissible": self.admissible,
                "impacts": [
                    f"{self.params.system.letters([side], [ball])} at {t:.6g}, w' = {speed:.6g}"
                    for side, ball, t, speed in zip(self.side, self.word.balls, self.t, self.w_dot, strict=True)
                ],
                "multipliers": self.multipliers.tolist(),
                "K2/K1": m.kinetic_ratio if moves else None,
                "max|x1|": m.max_abs_x1 if moves else None,
                "residual": f"{self.residual:.1e}",
                "remark": self.remark or None,
            },
        )
