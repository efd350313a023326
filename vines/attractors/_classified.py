"""What many runs settled to, in arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from vines.attractors import _verdict as v
from vines.attractors._attractor import Attractor
from vines.attractors._naming import attractor_from
from vines.dynamics.kernels import rows as col
from vines.dynamics.kernels import totals as entry
from vines.dynamics.runs import STATUS_NAMES, impacts_of, measures_of
from vines.model import FREQUENCY, MASS, PARAMETER_NAMES, Params

__all__ = ["NO_IMPACTS", "Classified"]

Floats = npt.NDArray[np.float64]

NO_IMPACTS = impacts_of(np.empty((0, col.ROW)))


@dataclass(frozen=True)
class Classified:
    """What many runs settled to; row k of every array belongs to run k. `attractor` gives one as an `Attractor`.

    Attributes
    ----------
    parameters : ndarray, shape (n, 5)
        mu, A, Omega, r, lam.
    starts : ndarray, shape (n, 5)
        x1, v1, x2, v2 and phase [rad].
    words : ndarray of object, shape (n,)
        `Word` of the contacts of one repetition, None where the run is not periodic.
    verdicts : ndarray, shape (n, VERDICT)
        The numbers behind everything else, as the kernels wrote them.
    totals : ndarray, shape (n, TOTALS)
        Totals of the window that the measures are taken over.
    hits : list of structured ndarray, or None
        Recorded impacts of each run, as `Attractor.impacts`, where they were asked for.
    """

    parameters: Floats
    starts: Floats
    words: npt.NDArray[np.object_]
    verdicts: Floats = field(repr=False)
    totals: Floats = field(repr=False)
    hits: list[npt.NDArray[np.void]] | None = field(default=None, repr=False)

    def __len__(self) -> int:
        return len(self.verdicts)

    def attractor(self, k: int) -> Attractor:
        """Return run k as `settle` would: one object with names for everything."""
        p = Params(**dict(zip(PARAMETER_NAMES, self.parameters[k].tolist(), strict=True)))
        hits = NO_IMPACTS if self.hits is None else self.hits[k]
        return attractor_from(p, self.verdicts[k], self.totals[k], self.words[k], hits, 0.0, True)

    def _whole(self, column: int) -> npt.NDArray[np.int64]:
        return self.verdicts[:, column].astype(np.int64)

    @property
    def regime(self) -> npt.NDArray[np.str_]:
        """``periodic``, ``quasiperiodic``, ``chaotic``, ``no_impact`` or ``unsettled``."""
        return np.array(v.REGIMES)[self._whole(v.REGIME)]

    @property
    def settled(self) -> npt.NDArray[np.bool_]:
        """Whether the run reached its attractor."""
        return self.verdicts[:, v.SETTLED] > 0

    @property
    def n(self) -> npt.NDArray[np.int64]:
        """Contacts on L in p forcing periods, 0 where the run is not periodic."""
        return self._whole(v.LEFT)

    @property
    def m(self) -> npt.NDArray[np.int64]:
        """Contacts on R in p forcing periods, 0 where the run is not periodic."""
        return self._whole(v.RIGHT)

    @property
    def p(self) -> npt.NDArray[np.int64]:
        """Smallest number of forcing periods after which the run repeats, 0 where it does not."""
        return self._whole(v.P)

    @property
    def name(self) -> npt.NDArray[np.object_]:
        """Type n:m/pT, None where the run is not periodic."""
        return np.array([word.name if word else None for word in self.words], dtype=object)

    @property
    def symmetric(self) -> npt.NDArray[np.bool_]:
        """Whether a periodic run is its own mirror image."""
        return self.verdicts[:, v.SYMMETRIC] > 0

    @cached_property
    def measures(self) -> npt.NDArray[np.void]:
        """Energy measures as `Ensemble.measures`: over one repetition if periodic, else over the recorded window."""
        return measures_of(self.parameters[:, MASS], self.totals)

    @property
    def errors(self) -> Floats:
        """Standard errors of K2/K1, of the largest |x1| and of rms x1, shape (n, 3), as those of an `Attractor`."""
        return self.verdicts[:, [v.KINETIC_RATIO_ERROR, v.MAX_ABS_X1_ERROR, v.RMS_X1_ERROR]]

    @property
    def sticks(self) -> Floats:
        """Spells of sticking per forcing period."""
        sticks = self.totals[:, entry.STICKS_LEFT] + self.totals[:, entry.STICKS_RIGHT]
        with np.errstate(invalid="ignore", divide="ignore"):
            return sticks * (2.0 * np.pi / self.parameters[:, FREQUENCY]) / self.totals[:, entry.DURATION]

    @property
    def sticking_share(self) -> Floats:
        """Share of the forcing periods in which the ball sticks for a while."""
        return self.verdicts[:, v.STICKING]

    @property
    def recurrent_sticking(self) -> npt.NDArray[np.bool_]:
        """Whether sticking recurs: see `Attractor`."""
        return (self.sticking_share >= v.RECURS) | ((self.p > 0) & (self.sticking_share > 0))

    @property
    def lyapunov(self) -> Floats:
        """Largest Lyapunov exponent per unit of time; nan where the run is not settled and none was needed."""
        return self.verdicts[:, v.EXPONENTS]

    @property
    def lyapunov_error(self) -> Floats:
        """Standard error of `lyapunov`, 0 where the run is periodic."""
        return self.verdicts[:, v.LYAPUNOV_ERROR]

    @property
    def remaining(self) -> Floats:
        """Estimated forcing periods still needed where the run is not settled."""
        return self.verdicts[:, v.REMAINING]

    @property
    def transient(self) -> Floats:
        """Forcing periods run before the recording."""
        return self.verdicts[:, v.PERIODS]

    @property
    def watched(self) -> Floats:
        """Forcing periods over which a motion that never repeated was seen to last, 0 where it was not watched."""
        return self.verdicts[:, v.WATCHED]

    @property
    def final(self) -> Floats:
        """State at the end, shape (n, 5): x1, v1, x2, v2 and phase [rad]."""
        return self.verdicts[:, v.FINAL : v.FINAL + 5]

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """``complete``, ``impact_cap`` or ``step_limit``."""
        codes = self._whole(v.STATUS)
        return np.where(codes == col.EVENT_CAP, STATUS_NAMES[1], np.where(codes > 0, STATUS_NAMES[2], STATUS_NAMES[0]))

    @property
    def reason(self) -> npt.NDArray[np.object_]:
        """Why a run is called unsettled, or what was noted on the way; empty if nothing."""
        return np.array([v.reason_text(verdict) for verdict in self.verdicts], dtype=object)
