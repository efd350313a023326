"""Reading a declaration and the file that it includes: one level, so that a reader has two files to look at at most."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError, FileMissingError

__all__ = ["merged", "parse", "with_included"]

_BY_NAME = ("params", "vary")
"""Tables inside a stage that are merged name by name; every other value of a stage replaces the included one."""


def parse(path: Path) -> dict[str, Any]:
    """Read a TOML file; decimals stay what was written. Tables inside are shared: whoever changes one copies it first.

    Raises
    ------
    FileMissingError
        If there is no such file.
    DeclarationError
        If it cannot be read, or is not TOML.
    """
    try:
        text = path.read_text("utf-8-sig")  # some editors put a mark before the text, which TOML does not have
        if "\0" in text:
            raise DeclarationError(f"{path} is UTF-16; TOML is UTF-8: save it as UTF-8")
        return dict(_loads(text))
    except FileNotFoundError:
        raise FileMissingError(f"{path}: there is no such file; 'vines list' shows the pipelines there are") from None
    except OSError as error:
        raise DeclarationError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        at = f"byte {error.object[error.start]:#x} in line {error.object.count(10, 0, error.start) + 1}"
        found = "UTF-16" if b"\0" in error.object else f"not UTF-8 ({at})"
        raise DeclarationError(f"{path} is {found}; TOML is UTF-8: save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise DeclarationError(f"{path}: not a TOML file: {str(error).splitlines()[0]}") from None


@functools.lru_cache(maxsize=1024)
def _loads(text: str) -> dict[str, Any]:
    """Parse a text once: a declaration is read for its title, as a collection, and as a pipeline."""
    return tomllib.loads(text, parse_float=Decimal)


def with_included(path: Path) -> dict[str, Any]:
    """Read a declaration and lay it over the file that it includes, if it includes one.

    Raises
    ------
    FileMissingError
        If one of the files does not exist.
    DeclarationError
        If one is not TOML, or the included one includes another.
    """
    own = parse(path)
    if "include" not in own:
        return own
    name = own.pop("include")
    if not isinstance(name, str):
        raise DeclarationError(f'{path}: include is {name!r}; name one file, such as include = "common/runs.toml"')
    other = path.parent / name
    if not other.is_file():
        raise FileMissingError(f"{path}: include: there is no file {other}; the name is relative to {path.parent}")
    base = parse(other)
    if "include" in base:
        raise DeclarationError(f"{other}: an included file cannot include another; {path.name} includes it already")
    return merged(base, own)


def merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Lay a declaration over another: parameters, stages, and inside a stage its keys, one by one.

    Examples
    --------
    >>> merged({"stages": {"up": {"kind": "sweep", "settle": 400}}}, {"stages": {"up": {"settle": 10}}})
    {'stages': {'up': {'kind': 'sweep', 'settle': 10}}}
    """
    form = {**base, **own}
    for key in ("params", "stages"):
        under, over = base.get(key), own.get(key)
        if isinstance(under, Mapping) and isinstance(over, Mapping):
            form[key] = {**under, **over}
            if key == "stages":
                form[key] |= {name: _stage(under[name], over[name]) for name in under if name in over}
    return form


def _stage(under: Any, over: Any) -> Any:
    if not isinstance(under, Mapping) or not isinstance(over, Mapping):
        return over
    form = {**under, **over}
    for key in _BY_NAME:
        if isinstance(under.get(key), Mapping) and isinstance(over.get(key), Mapping):
            form[key] = {**under[key], **over[key]}
    return form
