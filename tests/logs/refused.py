"""Refusals of logs in one line."""

from vines.errors import LogError


def or_refused(attempt):
    """Return what an attempt gives, or None if it is refused in one line."""
    try:
        return attempt()
    except LogError as error:
        said = str(error)
    assert said.isprintable()
    return None
