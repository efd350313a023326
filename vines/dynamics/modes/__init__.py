"""A structure of several modes with a ball in a cavity at a place of it; docs/dynamics.md, "Several modes"."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from vines.dynamics._impact_law import ImpactLaw, impact_law
from vines.dynamics._room import Layout, Room, Slopes
from vines.dynamics._start import check_gap
from vines.dynamics.modes import _energies as _energies
from vines.dynamics.modes import _tangent as _tangent
from vines.dynamics.modes._advance import set_modes
from vines.dynamics.modes._constants import ModesConstants, ModesTable, modes_constants
from vines.dynamics.modes._layout import row_width, state_size, totals_size
from vines.dynamics.modes._run import ModalMeasures, ModesMeasures, ModesRun, modes_measures

__all__ = ["ROOM", "ModalMeasures", "ModesConstants", "ModesMeasures", "ModesRun"]


class _Modes(Room):
    """x2 and v2 are arrays: of the ball, then of each mode from the second on."""

    trajectory = ModesRun
    measures = staticmethod(modes_measures)

    def constants(self, values: Sequence[float]) -> ModesConstants:
        return modes_constants(*values)

    def table(self, points: list[list[float]]) -> ModesTable:
        return ModesTable(self.constants(points[0]))

    def layout(self, p: Any) -> Layout:
        n = p.modes
        return Layout(state_size(n), row_width(n), totals_size(n), 2 + 2 * n)

    def enter(self, p: Any, start: Mapping[str, Any], phase: float) -> tuple[Any, Any, Any, Any]:
        check_gap(start["x1"] - start["x2"])
        others = range(2, p.modes + 1)
        x2 = np.array([start["x2"], *(start[f"q_{k}"] for k in others)])
        v2 = np.array([start["v2"], *(start[f"q_dot_{k}"] for k in others)])
        return start["x1"], start["v1"], x2, v2

    def leave(self, p: Any, at: Sequence[float], phase: float, more: Sequence[float] = ()) -> dict[str, float]:
        found: dict[str, float] = dict(zip(("x1", "v1", "x2", "v2"), at, strict=True))
        for k in range(2, p.modes + 1):
            found[f"q_{k}"], found[f"q_dot_{k}"] = more[1 + 2 * k], more[2 + 2 * k]
        return found

    def begin(self, c: Any, state: npt.NDArray[np.float64], x1: float, v1: float, x2: Any, v2: Any,
              phase: float, t: float) -> None:  # fmt: skip
        set_modes(c, state, float(x1), float(v1), x2, v2, phase, t)

    def draw(self, p: Any, rng: np.random.Generator) -> dict[str, float]:
        # As of the VI-NES; all modes but the first begin at rest.
        found = super().draw(p, rng)
        return found | {f"{name}_{k}": 0.0 for k in range(2, p.modes + 1) for name in ("q", "q_dot")}

    def amplitude(self, p: Any, mass: float) -> float:
        each = [
            (phi, gamma, omega**2 + 1j * lam * p.Omega, omega**2 - p.Omega**2 + 1j * lam * p.Omega)
            for omega, lam, phi, gamma in zip(p.omega, p.lam, p.phi, p.gamma, strict=True)
        ]
        if any(away == 0 for *_, away in each):
            return math.inf if mass == 1.0 and p.A > 0 else math.nan
        moved = p.direct + sum(phi * gamma * push / away for phi, gamma, push, away in each)
        # A ball of this mass presses with Omega² x1 on it.
        softer = 1.0 - (mass - 1.0) * p.Omega**2 * sum(phi**2 / away for phi, _, _, away in each)
        return p.A * abs(moved) / abs(softer) if softer != 0 else math.inf

    def pushed(self, p: Any, x1: Any, v1: Any, phase: Any, beside: Any) -> Any:
        e, rate = p.A * np.sin(phase), p.A * p.Omega * np.cos(phase)
        by_base, by_rate = self._by_base(p)
        found = by_base * e + by_rate * rate - p.omega[0] ** 2 * x1 - p.lam[0] * v1
        for k, (stiffer, damped) in enumerate(self._beyond_first(p)):
            found = found + stiffer * beside[2 * k] + damped * beside[2 * k + 1]
        return found

    def slopes(self, p: Any, x1: float, v1: float, phase: float, beside: npt.NDArray[np.float64]) -> Slopes:
        e, rate = p.A * math.sin(phase), p.A * p.Omega * math.cos(phase)
        by_base, by_rate = self._by_base(p)
        by_state = [-(p.omega[0] ** 2), -p.lam[0]]
        rates, blown = [], []
        for k, (stiffer, damped) in enumerate(self._beyond_first(p)):
            omega, lam, phi, gamma = (each[k + 1] for each in (p.omega, p.lam, p.phi, p.gamma))
            q, q_dot = float(beside[2 * k]), float(beside[2 * k + 1])
            by_state += [stiffer, damped]
            rates += [q_dot, omega**2 * (gamma * e - q) + lam * (gamma * rate - q_dot)]
            blown += [0.0, phi / p.mobility]
        by_time = by_base * rate - by_rate * p.Omega**2 * e
        return Slopes(by_time, np.array(by_state), np.array(rates), np.array(blown))

    def alongside(self, p: Any) -> tuple[float, ...]:
        return (0.0,) * (2 * p.modes - 2)

    def _by_base(self, p: Any) -> tuple[float, float]:
        """Return the derivatives of the push by displacement and velocity of the base, x1 and x1' fixed."""
        each = list(zip(p.omega, p.lam, p.phi, p.gamma, strict=True))
        stiff = sum(phi * gamma * omega**2 for omega, _, phi, gamma in each)
        damped = sum(phi * gamma * lam for _, lam, phi, gamma in each)
        return stiff + p.direct * (p.omega[0] ** 2 - p.Omega**2), damped + p.direct * p.lam[0]

    def _beyond_first(self, p: Any) -> list[tuple[float, float]]:
        """Return the same by amplitude and velocity of each mode from the second on: x1 says what the first is."""
        others = list(zip(p.omega, p.lam, p.phi, strict=True))[1:]
        return [(phi * (p.omega[0] ** 2 - omega**2), phi * (p.lam[0] - lam)) for omega, lam, phi in others]

    def law(self, p: Any, balls: Any) -> ImpactLaw:
        return impact_law(p.mu * p.mobility, p.r)

    def frame_energy(self, p: Any, at: Mapping[str, float], sag: float) -> float:
        others = [
            (phi, at[f"q_{k}"], at[f"q_dot_{k}"]) for k, phi in enumerate(p.phi[1:], start=2)
        ]  # fmt: skip
        first = (
            (at["x1"] - sum(phi * q for phi, q, _ in others)) / p.phi[0],
            (at["v1"] - sum(phi * q_dot for phi, _, q_dot in others)) / p.phi[0],
        )
        each = [first, *((q, q_dot) for _, q, q_dot in others)]
        return sum(
            0.5 * (q_dot**2 + (omega * q) ** 2) for omega, (q, q_dot) in zip(p.omega, each, strict=True)
        )  # fmt: skip

    def conserves(self, p: Any) -> bool:
        return all(lam == 0.0 for lam in p.lam) and p.r == 1.0

    def stored(self, p: Any, at: Any) -> tuple[Any, Any, Any]:
        each = list(enumerate(zip(p.omega, p.gamma, strict=True), start=1))
        frame = sum(0.5 * at[f"q_dot_{k}"] ** 2 for k, _ in each)
        strain = sum(0.5 * omega**2 * (at[f"q_{k}"] - gamma * at["base"]) ** 2 for k, (omega, gamma) in each)
        return frame, 0.5 * p.mu * at["v2"] ** 2, strain


ROOM = _Modes()
