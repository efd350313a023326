"""The rig: measured runs in, an honest verdict out. Tables and arrays in memory; no other sibling room is imported.

Its rooms, from below: `formats` reads files of recorders, `ingest` run folders; `fit` has the oscillator's motion at
given impacts, `impacts` finds these; `ball` and `quantities` say what follows, `verdict` lays that beside the model.
`records` is what is kept of a run, `synth` a rig to test all that with.

Lazy (PEP 562): the names of the room load neither scipy nor a library of a format.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
