"""The store: keys, immutable results, pools of points, pins; every write is atomic.

Lazy (PEP 562): to read pins and manifests loads neither pyarrow nor filelock.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
