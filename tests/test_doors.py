"""Registers of what others may add."""

from __future__ import annotations

from vines.rig.formats import FORMATS, readers


def test_the_order_of_names_does_not_depend_on_what_was_asked_for() -> None:
    before = FORMATS.names(), readers()
    for name in reversed(FORMATS.names()):
        FORMATS.get(name)
    assert (FORMATS.names(), readers()) == before
