"""What a study tells a data repository: title, creators, licence of the data."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

__all__ = ["LICENCES", "Creator", "Deposit", "Related"]

LICENCES = {
    "CC0-1.0": ("CC0 1.0 Universal", "https://creativecommons.org/publicdomain/zero/1.0/"),
    "CC-BY-4.0": ("Creative Commons Attribution 4.0 International", "https://creativecommons.org/licenses/by/4.0/"),
    "CC-BY-SA-4.0": (
        "Creative Commons Attribution Share Alike 4.0 International",
        "https://creativecommons.org/licenses/by-sa/4.0/",
    ),
    "CC-BY-NC-4.0": (
        "Creative Commons Attribution Non Commercial 4.0 International",
        "https://creativecommons.org/licenses/by-nc/4.0/",
    ),
    "ODC-By-1.0": ("Open Data Commons Attribution License v1.0", "https://opendatacommons.org/licenses/by/1-0/"),
    "ODbL-1.0": ("Open Data Commons Open Database License v1.0", "https://opendatacommons.org/licenses/odbl/1-0/"),
    "PDDL-1.0": (
        "Open Data Commons Public Domain Dedication & License 1.0",
        "https://opendatacommons.org/licenses/pddl/1-0/",
    ),
}
"""Licences for data, by their identifiers in the SPDX list: name and address."""

_Text = Annotated[str, Meta(min_length=1)]
_Doi = Annotated[str, Meta(extra_json_schema={"pattern": r"^10\.[0-9]{4,9}/\S+$"})]


class Creator(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Who made the study: a person as "Family, Given", with the identifier of ORCID and an institution."""

    name: Annotated[_Text, Meta(description='"Family, Given", or the name of a group')]
    orcid: Annotated[str, Meta(description="Identifier, 0000-0000-0000-0000")] = ""
    affiliation: Annotated[str, Meta(description="Institution")] = ""


class Related(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A paper, data or software that the study belongs to."""

    doi: Annotated[_Doi, Meta(description="Its DOI, without address")]
    relation: Annotated[
        str,
        Meta(
            description="How the study stands to it, a relation of DataCite",
            extra_json_schema={"enum": ["IsSupplementTo", "IsDerivedFrom", "Cites", "References", "IsNewVersionOf"]},
        ),
    ] = "IsSupplementTo"


class Deposit(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What `vines export` tells a data repository; the licence is that of the data."""

    title: Annotated[_Text, Meta(description="Title of the data set")]
    creators: Annotated[tuple[Creator, ...], Meta(min_length=1, description="Who made it")]
    licence: Annotated[
        str, Meta(description="Licence of the data in the SPDX list", extra_json_schema={"enum": list(LICENCES)})
    ]
    description: Annotated[str, Meta(description="What it is, in some sentences")] = ""
    keywords: Annotated[tuple[_Text, ...], Meta(description="Words by which it is found")] = ()
    version: Annotated[_Text, Meta(description="Version of the data")] = "1.0.0"
    publisher: Annotated[str, Meta(description="Repository")] = ""
    year: Annotated[Annotated[int, Meta(ge=1990, le=2200)] | None, Meta(description="Year of publication")] = None
    language: Annotated[_Text, Meta(description="Of the texts")] = "en"
    doi: Annotated[_Doi | None, Meta(description="DOI of the data set, if it has one, without address")] = None
    related: Annotated[tuple[Related, ...], Meta(description="What it belongs to")] = ()
