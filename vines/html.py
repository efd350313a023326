"""Small HTML tables, by which notebooks show results. Imports nothing of vines."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping

__all__ = ["html_table"]


def html_table(title: str, facts: Mapping[str, object]) -> str:
    """Return a table of two columns under a title.

    Parameters
    ----------
    title : str
        The caption.
    facts : mapping of str to object
        Name and value of each row. Numbers have six digits; of a list each value has a line; ``None`` leaves a row out.

    Examples
    --------
    >>> html_table("1:1", {"ends": ["range", "a < b"], "remark": None})
    '<table><caption>1:1</caption><tr><th>ends</th><td>range<br>a &lt; b</td></tr></table>'
    """
    rows = "".join(
        f"<tr><th>{html.escape(name)}</th><td>{'<br>'.join(_cell(value))}</td></tr>"
        for name, value in facts.items()
        if value is not None
    )
    return f"<table><caption>{html.escape(title)}</caption>{rows}</table>"


def _cell(value: object) -> Iterable[str]:
    if isinstance(value, list):
        return [line for each in value for line in _cell(each)]
    if isinstance(value, bool):
        return ["yes" if value else "no"]
    if isinstance(value, complex):
        return [f"{value.real:.6g} {value.imag:+.6g}i" if value.imag else f"{value.real:.6g}"]
    return [f"{value:.6g}" if isinstance(value, float) else html.escape(str(value))]
