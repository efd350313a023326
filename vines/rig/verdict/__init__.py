"""A run beside the branches of the model that coexist at its parameters, and what is said about it."""

from vines.rig.verdict._compare import Calibration, calibrate, compare, compare_all
from vines.rig.verdict._match import Candidate, word_of
from vines.rig.verdict._model import Predicted, measured_params
from vines.rig.verdict._sensitivity import Numbers, sensitivity
from vines.rig.verdict._verdict import VERDICTS, Comparison, Likeness

__all__ = [
    "VERDICTS",
    "Calibration",
    "Candidate",
    "Comparison",
    "Likeness",
    "Numbers",
    "Predicted",
    "calibrate",
    "compare",
    "compare_all",
    "measured_params",
    "sensitivity",
    "word_of",
]
