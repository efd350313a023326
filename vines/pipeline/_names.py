"""Names of pipelines and stages."""

from __future__ import annotations

import re

__all__ = ["NAME", "RESERVED"]

NAME = re.compile(r"[a-z][a-z0-9_]*")

_WORDS = """
all analyse analyze and any array as asc asymmetric both case cast check collate column constraint create
default deferrable desc describe distinct do else end except false fetch for foreign from group having in
information_schema initially intersect into lambda lateral leading limit main memory not null offset on only
or order pg_catalog pivot pivot_longer pivot_wider placing primary qualify references returning select show
some summarize symmetric system table temp then to trailing true union unique unpivot using variadic when
where window with
"""

RESERVED = frozenset(_WORDS.split())
"""Words that SQL keeps for itself; a pipeline's name stands unquoted before the dot in ``<pipeline>.<stage>``."""
