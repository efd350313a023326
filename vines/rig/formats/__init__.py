"""Formats of recorders: one module each, and the choice between them by what a file begins with."""

from vines.rig.formats._choose import FORMS, read_file
from vines.rig.formats._raw import RawChannel, RawFile

__all__ = ["FORMS", "RawChannel", "RawFile", "read_file"]
