"""Text as loggers write it: encoding, dialect, head, time stamps, and the columns that follow from them."""

from vines.rig.formats._csv._encoding import to_utf8
from vines.rig.formats._csv._read import read

__all__ = ["read", "to_utf8"]
