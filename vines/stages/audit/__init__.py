"""Audit: whether what is stored is intact, physically consistent, and computed again the same (``vines verify``)."""

from vines.stages.audit._ledger import Line
from vines.stages.audit._verify import Verification, verify

__all__ = ["Line", "Verification", "verify"]
