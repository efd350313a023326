"""Systems beside the vibro-impact nonlinear energy sink: their parameters, and the register of all.

Everything public of vines takes them where it takes `vines.Params`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
