"""What a simulation settles to: n:m/pT, quasi-periodic, chaotic, without impact, or not settled yet."""

from vines.attractors import _modal as _modal
from vines.attractors import _stroboscope as _stroboscope
from vines.attractors import _to_and_fro as _to_and_fro
from vines.attractors._alike import SAME, Motion, apart
from vines.attractors._atlas import Atlas, Entry, atlas
from vines.attractors._attractor import Attractor
from vines.attractors._basins import Basins, basins
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.attractors._coexisting import coexisting, random_starts
from vines.attractors._exit_times import Exits, exits
from vines.attractors._exit_work import EXIT
from vines.attractors._holding import Holding, mean_interval, stationary_law
from vines.attractors._orbit_of import orbit_of, orbit_through
from vines.attractors._search import Lifetime
from vines.attractors._settle import APART, settle, settle_from
from vines.attractors._shares import share_error
from vines.attractors._warm_up import warm_up

__all__ = [
    "APART",
    "EXIT",
    "SAME",
    "Atlas",
    "Attractor",
    "Basins",
    "Classified",
    "Entry",
    "Exits",
    "Holding",
    "Lifetime",
    "Motion",
    "apart",
    "atlas",
    "basins",
    "classify_many",
    "coexisting",
    "exits",
    "mean_interval",
    "orbit_of",
    "orbit_through",
    "random_starts",
    "settle",
    "settle_from",
    "share_error",
    "stationary_law",
    "warm_up",
]
