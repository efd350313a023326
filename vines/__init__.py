"""vines: reproducible studies of the vibro-impact nonlinear energy sink.

The names below are loaded when they are first used, so that ``import vines`` costs next to nothing.

Examples
--------
>>> import vines
>>> p = vines.Params(mu=0.01, A=0.015)
>>> vines.settle(p).name
'1:1'
"""

import lazy_loader

from vines import imported as imported

__version__ = "0.2.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
