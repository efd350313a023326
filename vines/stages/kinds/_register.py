"""The kinds of stages that vines knows: light specifications, without numba, pyarrow, rerun or matplotlib.

A body is named by its dotted path and imported only when there is something to compute.
"""

from __future__ import annotations

from vines.stages.kinds._formulas import register_formulas
from vines.stages.kinds._orbits import register_orbits
from vines.stages.kinds._rig import register_rig
from vines.stages.kinds._runs import register_runs
from vines.stages.kinds._shown import register_shown

__all__ = ["register_kinds"]


def register_kinds() -> None:
    """Make the kinds of vines known to declarations; calling it again changes nothing."""
    register_runs()
    register_orbits()
    register_formulas()
    register_shown()
    register_rig()
