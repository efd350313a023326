"""A run beside the branches of the model that coexist at its parameters, and what is said about it."""

from vines.rig.verdict._compare import Calibration, calibrate, compare, compare_all
from vines.rig.verdict._match import Candidate, word_of
from vines.rig.verdict._model import Predicted
from vines.rig.verdict._verdict import VERDICTS, Comparison, Likeness

__all__ = [
    "VERDICTS",
    "Calibration",
    "Candidate",
    "Comparison",
    "Likeness",
    "Predicted",
    "calibrate",
    "compare",
    "compare_all",
    "word_of",
]
