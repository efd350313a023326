"""What a data repository reads of an export: Data Package, DataCite, CITATION.cff, and the licence."""

from __future__ import annotations

import json
import re
from typing import Any

from vines.catalogue._study import LICENCES, Creator, Deposit

__all__ = ["citation", "datacite", "licence", "package_fields"]

_RESOLVER = "https://doi.org/"


def package_fields(deposit: Deposit) -> dict[str, Any]:
    """Return the fields of a Data Package (Frictionless, version 1) that tell of the study.

    Parameters
    ----------
    deposit : Deposit
        What ``[study]`` says.
    """
    found: dict[str, Any] = {
        "name": re.sub(r"[^a-z0-9]+", "-", deposit.title.lower()).strip("-") or "study",
        "title": deposit.title,
        "description": deposit.description,
        "version": deposit.version,
        "keywords": list(deposit.keywords),
        "licenses": [{"name": deposit.licence, "path": LICENCES[deposit.licence][1]}],
        "contributors": [_contributor(each) for each in deposit.creators],
        "id": f"{_RESOLVER}{deposit.doi}" if deposit.doi else "",
    }
    return {key: value for key, value in found.items() if value}


def _contributor(creator: Creator) -> dict[str, str]:
    found = {"title": _spoken(creator.name), "role": "author", "organization": creator.affiliation}
    if creator.orcid:
        found["path"] = f"https://orcid.org/{creator.orcid}"
    return {key: value for key, value in found.items() if value}


def _spoken(name: str) -> str:
    """Return a name as it is said.

    Examples
    --------
    >>> _spoken("Doe, A."), _spoken("A group")
    ('A. Doe', 'A group')
    """
    family, comma, given = name.partition(",")
    return f"{given.strip()} {family.strip()}" if comma else name


def datacite(deposit: Deposit) -> str:
    """Return the metadata of DataCite (schema 4.5) as JSON, without what is not said: a repository fills it in.

    Parameters
    ----------
    deposit : Deposit
        What ``[study]`` says.
    """
    name, address = LICENCES[deposit.licence]
    creators = []
    for each in deposit.creators:
        family, comma, given = each.name.partition(",")
        one: dict[str, Any] = {"name": each.name, "nameType": "Personal" if comma else "Organizational"}
        if comma:
            one |= {"givenName": given.strip(), "familyName": family.strip()}
        if each.affiliation:
            one["affiliation"] = [{"name": each.affiliation}]
        if each.orcid:
            one["nameIdentifiers"] = [
                {
                    "nameIdentifier": f"https://orcid.org/{each.orcid}",
                    "nameIdentifierScheme": "ORCID",
                    "schemeUri": "https://orcid.org",
                }
            ]
        creators.append(one)
    found: dict[str, Any] = {
        "doi": deposit.doi,
        "types": {"resourceType": "Dataset", "resourceTypeGeneral": "Dataset"},
        "creators": creators,
        "titles": [{"title": deposit.title}],
        "publisher": {"name": deposit.publisher} if deposit.publisher else None,
        "publicationYear": str(deposit.year) if deposit.year else None,
        "subjects": [{"subject": each} for each in deposit.keywords],
        "language": deposit.language,
        "version": deposit.version,
        "rightsList": [
            {
                "rights": name,
                "rightsUri": address,
                "rightsIdentifier": deposit.licence,
                "rightsIdentifierScheme": "SPDX",
                "schemeUri": "https://spdx.org/licenses/",
            }
        ],
        "descriptions": [{"description": deposit.description, "descriptionType": "Abstract"}]
        if deposit.description
        else None,
        "formats": ["application/vnd.apache.parquet"],
        "relatedIdentifiers": [
            {"relatedIdentifier": each.doi, "relatedIdentifierType": "DOI", "relationType": each.relation}
            for each in deposit.related
        ],
        "schemaVersion": "http://datacite.org/schema/kernel-4",
    }
    return json.dumps({key: value for key, value in found.items() if value}, indent=1, ensure_ascii=False) + "\n"


def licence(deposit: Deposit) -> str:
    """Return the text of LICENSE: which licence the data have, and where its text is."""
    name, address = LICENCES[deposit.licence]
    who = "; ".join(_spoken(each.name) for each in deposit.creators)
    year = f" {deposit.year}" if deposit.year else ""
    return (
        f"Copyright{year} {who}\n\nThe data in this folder are licensed under {name} ({deposit.licence}).\n"
        f"The text of the licence: {address}\n"
    )


def citation(deposit: Deposit) -> str:
    """Return the text of CITATION.cff (1.2.0): how to cite the data."""
    lines = [
        "cff-version: 1.2.0",
        'message: "If you use these data, please cite them as below."',
        "type: dataset",
        f"title: {json.dumps(deposit.title, ensure_ascii=False)}",
        "authors:",
    ]
    for each in deposit.creators:
        family, comma, given = each.name.partition(",")
        told = {"family-names": family.strip(), "given-names": given.strip()} if comma else {"name": each.name}
        told |= {"affiliation": each.affiliation} if each.affiliation else {}
        told |= {"orcid": f"https://orcid.org/{each.orcid}"} if each.orcid else {}
        for number, (key, value) in enumerate(told.items()):
            lines.append(f"  {'- ' if number == 0 else '  '}{key}: {json.dumps(value, ensure_ascii=False)}")
    lines += [f"version: {json.dumps(deposit.version)}", f"license: {deposit.licence}"]
    lines += [f"doi: {deposit.doi}"] if deposit.doi else []
    lines += [f"abstract: {json.dumps(deposit.description, ensure_ascii=False)}"] if deposit.description else []
    words = [f"  - {json.dumps(each, ensure_ascii=False)}" for each in deposit.keywords]
    lines += ["keywords:", *words] if words else []
    return "\n".join(lines) + "\n"
