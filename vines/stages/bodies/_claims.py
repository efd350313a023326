"""Published values: what ``claims.toml`` may say."""

from __future__ import annotations

import functools
import tomllib
from pathlib import Path
from typing import Literal

import msgspec

from vines.errors import DeclarationError

__all__ = ["REASONS", "Claim", "Reason", "read_claims"]

Reason = Literal["", "misprint", "read off a plot", "sensitivity", "true in part", "not so"]

REASONS: dict[Reason, str] = {
    "misprint": "the print has a wrong number or word",
    "read off a plot": "the value was read off a plot, less precisely than it is printed",
    "sensitivity": "the value depends on what the paper does not say: starts, steps, length of the run",
    "true in part": "it holds for some of the cases it is said of",
    "not so": "the exact model says otherwise",
}
"""Why our value may differ from the published one."""


class Claim(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A published value and the query that finds ours.

    Parameters
    ----------
    source : str
        Figure, section or table of the paper.
    statement : str
        What is claimed, in our words.
    published : float or str
        The value, or the answer in words.
    ours : str
        A query over the tables of the needed stages. It gives one row: the value, and in a second column, if there is
        one, the numbers behind an answer in words. May be left out of a claim that is `not_reproducible`.
    tolerance : float, optional
        The precision of the print; texts have none.
    printed : str
        The value as it stands in print, where a number alone does not say it, such as ``"≈ 0.4"``.
    reason : str
        Kind of a known difference, one of `REASONS`.
    remark : str
        The difference explained, or what the value rests on.
    not_reproducible : str
        Why no value of ours can be compared.
    """

    source: str
    statement: str
    published: float | str
    ours: str = ""
    tolerance: float | None = None
    printed: str = ""
    reason: Reason = ""
    remark: str = ""
    not_reproducible: str = ""


def read_claims(file: Path) -> dict[str, Claim]:
    """Read published values.

    Raises
    ------
    DeclarationError
        If the file is not TOML, an entry is not a claim, or a claim lacks what its verdict needs.
    """
    return dict(_claims(file.name, file.read_text(encoding="utf-8")))


@functools.lru_cache(maxsize=4)
def _claims(file: str, text: str) -> dict[str, Claim]:
    """Convert a text once, however many stages check against it."""
    try:
        claims = msgspec.convert(tomllib.loads(text), dict[str, Claim])
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise DeclarationError(f"{file}: {error}; see docs/tables.md for the form of a claim") from None
    for name, claim in claims.items():
        missing = _missing(claim)
        if missing:
            raise DeclarationError(f"{file}: claim {name!r} {missing}")
    return claims


def _missing(claim: Claim) -> str:
    """Return what a claim lacks, with the remedy; empty if nothing."""
    if not claim.not_reproducible and not claim.ours.strip():
        return "has no query for our value; add ours, or say not_reproducible"
    if not isinstance(claim.published, str) and claim.tolerance is None and not claim.not_reproducible:
        return "publishes a number without a tolerance; add its precision"
    if isinstance(claim.published, str) and claim.tolerance is not None:
        return "publishes a text, which has no tolerance; take it away"
    if claim.reason and not claim.remark:
        return f"differs because of {claim.reason!r} but does not explain it; add a remark"
    return ""
