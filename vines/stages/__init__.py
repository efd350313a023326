"""Stages: the only room that sees physics and stored things. One module a kind, and the functions that users call.

Lazy (PEP 562): a list or a status loads no numba, pyarrow, rerun or matplotlib.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
