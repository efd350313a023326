"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported.

Lazy (PEP 562): the names of the room load neither scipy nor a library of a format.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
