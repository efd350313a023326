"""Formats of recorders: a file each, and the choice between them by what a file begins with.

A file without underscore is the format of that name. docs/rig.md.
"""

from vines.rig.formats._format import FORMATS, Format, list_formats, readers
from vines.rig.formats._raw import RawChannel, RawFile
from vines.rig.formats._read_file import read_file

__all__ = ["FORMATS", "Format", "RawChannel", "RawFile", "list_formats", "read_file", "readers"]
