"""Pipelines: declarations, kinds of stages, keys, points, plans, and the engine. Knows no physics."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
