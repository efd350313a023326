"""What a data repository asks of a study: ``[study]`` of a declaration. It counts in no key."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from vines.catalogue import LICENCES, Deposit
from vines.errors import DeclarationError
from vines.pipeline._options import known, option_names, read_options

__all__ = ["read_deposit"]


def read_deposit(declared: object, where: str) -> Deposit | None:
    """Return what ``[study]`` says, checked; None where there is none.

    Parameters
    ----------
    declared : object
        The table as plain data, or None.
    where : str
        File and key, for messages.

    Raises
    ------
    DeclarationError
        If a key or a value is not allowed.

    Examples
    --------
    >>> who = [{"name": "Doe, A."}]
    >>> read_deposit({"title": "Data", "creators": who, "licence": "CC-BY-4.0"}, "a.toml: study").version
    '1.0.0'
    >>> read_deposit({"title": "Data", "creators": who, "licence": "BSD-3-Clause"}, "a.toml: study")
    Traceback (most recent call last):
        ...
    vines.errors.DeclarationError: a.toml: study.licence is 'BSD-3-Clause', which is none for data; allowed: ...
    """
    if declared is None:
        return None
    if not isinstance(declared, Mapping):
        raise DeclarationError(f"{where} is {declared!r}; it is a table, [study]")
    table: Any = declared
    known(table, option_names(Deposit), where)
    found: Any = read_options(table, Deposit, where)
    if found.licence not in LICENCES:
        allowed = ", ".join(sorted(LICENCES))
        raise DeclarationError(f"{where}.licence is {found.licence!r}, which is none for data; allowed: {allowed}")
    for number, creator in enumerate(found.creators):
        if creator.orcid and not _is_orcid(creator.orcid):
            raise DeclarationError(
                f"{where}.creators[{number}].orcid is {creator.orcid!r}; an ORCID is 0000-0000-0000-0000, "
                "its last character a check digit"
            )
    for key, doi in (("doi", found.doi), *((f"related[{k}].doi", each.doi) for k, each in enumerate(found.related))):
        if doi is not None and not re.fullmatch(r"10\.\d{4,9}/\S+", doi):
            raise DeclarationError(f"{where}.{key} is {doi!r}; a DOI is 10.NUMBER/NAME, without the address before it")
    return found


def _is_orcid(text: str) -> bool:
    """Say whether a text is an identifier of ORCID: 16 characters, the last of them ISO 7064 MOD 11-2 of the others.

    Examples
    --------
    >>> _is_orcid("0000-0002-1825-0097"), _is_orcid("0000-0002-1825-0098")
    (True, False)
    """
    if not re.fullmatch(r"\d{4}-\d{4}-\d{4}-\d{3}[\dX]", text):
        return False
    total = 0
    for digit in text.replace("-", "")[:15]:
        total = 2 * (total + int(digit))
    return "0123456789X"[(12 - total % 11) % 11] == text[-1]
