"""What a simulation settles to: n:m/pT, quasi-periodic, chaotic, without impact, or not settled yet."""

from vines.attractors import _stroboscope as _stroboscope
from vines.attractors._alike import SAME, Motion, apart
from vines.attractors._atlas import Atlas, Entry, atlas
from vines.attractors._attractor import Attractor
from vines.attractors._basins import Basins, basins
from vines.attractors._classified import Classified
from vines.attractors._classify import classify_many
from vines.attractors._orbit_of import orbit_of, orbit_through
from vines.attractors._search import Lifetime
from vines.attractors._settle import APART, settle, settle_from
from vines.attractors._shares import share_error
from vines.attractors._warm_up import warm_up

__all__ = [
    "APART",
    "SAME",
    "Atlas",
    "Attractor",
    "Basins",
    "Classified",
    "Entry",
    "Lifetime",
    "Motion",
    "apart",
    "atlas",
    "basins",
    "classify_many",
    "orbit_of",
    "orbit_through",
    "settle",
    "settle_from",
    "share_error",
    "warm_up",
]
