"""What stored rows of a structure of several modes say of it, in coordinates that move with its base."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vines.stages.audit._rows import Floats, Rows

__all__ = ["damping_of_modes", "mobility_of_modes", "modal_amplitude"]


def _each(rows: Rows) -> Iterator[tuple[Floats, Floats, Floats, Floats]]:
    """Yield omega, lam, phi and gamma of each mode; one that a row has not is one that takes no part."""
    for number in range(1, 10):
        if rows.has(f"omega_{number}"):
            omega, lam, phi, gamma = (rows[f"{name}_{number}"] for name in ("omega", "lam", "phi", "gamma"))
            none = np.isnan(omega)
            lam, phi, gamma = (np.where(none, 0.0, each) for each in (lam, phi, gamma))
            yield np.where(none, 1.0, omega), lam, phi, gamma


def modal_amplitude(rows: Rows, mass: Floats | float) -> Floats:
    """Return the steady amplitude of x1 with this mass fixed to the structure at the cavity."""
    A, square = rows["A"], rows["Omega"] ** 2
    moved, compliance = A.astype(complex), np.zeros(len(rows), dtype=complex)
    with np.errstate(divide="ignore", invalid="ignore"):
        for omega, lam, phi, gamma in _each(rows):
            answer = phi / (omega**2 - square + 1j * lam * rows["Omega"])
            moved = moved + answer * gamma * square * A
            compliance = compliance + answer * phi
        return np.abs(moved / (1.0 - mass * square * compliance))


def mobility_of_modes(rows: Rows) -> Floats:
    """Return by how much a unit impulse at the cavity changes its velocity."""
    return np.sum([phi**2 for _, _, phi, _ in _each(rows)], axis=0)


def damping_of_modes(rows: Rows) -> Floats:
    """Return the rate at which volumes of states contract between impacts."""
    return np.sum([lam for _, lam, _, _ in _each(rows)], axis=0)
