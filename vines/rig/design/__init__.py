"""What to measure next: where a dwell would tell most, where branches coexist, where a jump is near."""

from vines.rig.design._branch_map import Column, Stretch, branch_map
from vines.rig.design._information import Gain, gain, informed
from vines.rig.design._known import PARAMETERS, Known, known_of
from vines.rig.design._plan import Plan, Suggestion, plan_runs

__all__ = [
    "PARAMETERS",
    "Column",
    "Gain",
    "Known",
    "Plan",
    "Stretch",
    "Suggestion",
    "branch_map",
    "gain",
    "informed",
    "known_of",
    "plan_runs",
]
