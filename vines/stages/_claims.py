"""Published values: what ``claims.toml`` may say."""

from __future__ import annotations

import tomllib
from pathlib import Path

import msgspec

from vines.errors import DeclarationError

__all__ = ["Claim", "read_claims"]


class Claim(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A published value and the query that finds ours.

    `tolerance` is the precision of the print; texts have none. `remark` explains a known difference.
    `not_reproducible` says why no value of ours can exist.
    """

    source: str
    statement: str
    published: float | str
    ours: str
    tolerance: float | None = None
    remark: str = ""
    not_reproducible: str = ""


def read_claims(file: Path) -> dict[str, Claim]:
    """Read published values.

    Raises
    ------
    DeclarationError
        If the file is not TOML or an entry is not a claim.
    """
    try:
        claims = msgspec.convert(tomllib.loads(file.read_text(encoding="utf-8")), dict[str, Claim])
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise DeclarationError(f"{file.name}: {error}; see docs/tables.md for the form of a claim") from None
    for name, claim in claims.items():
        if not isinstance(claim.published, str) and claim.tolerance is None and not claim.not_reproducible:
            raise DeclarationError(
                f"{file.name}: claim {name!r} publishes a number without a tolerance; add its precision"
            )
    return claims
