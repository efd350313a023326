"""The forms of everything stored, read from ``schemas/``: the messages of logs and the columns of tables.

Lazy (PEP 562): a name loads its module on first use, so that a command that only needs tables loads no
protobuf and one that only needs messages no pyarrow.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
