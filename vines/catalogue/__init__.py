"""The catalogue: what is pinned now, as views of an in-memory DuckDB."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
