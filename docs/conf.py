"""How the pages of this folder become a site: `make docs` writes it to `site/`, without network."""

from __future__ import annotations

import ast
import importlib
import inspect
import itertools
import re
import textwrap
from pathlib import Path
from typing import Any

import vines

project = "vines"
author = "the maintainers of vines"
copyright = "the maintainers of vines, BSD-3-Clause"  # noqa: A001 - the name is Sphinx's
version = release = vines.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
html_theme = "furo"
html_title = f"vines {release}"
html_static_path: list[str] = []
html_show_sphinx = False
exclude_patterns = ["site"]
myst_heading_anchors = 4
myst_enable_extensions = ["deflist", "dollarmath"]
numpydoc_show_class_members = False  # autodoc lists them with what they do
numpydoc_class_members_toctree = False
autodoc_typehints = "none"  # the docstrings give types with shapes and units
autodoc_member_order = "bysource"

ROOMS = {
    "vines": "What most studies need: it is all that `import vines` offers.",
    "vines.systems": "The systems beside the VI-NES, and what they harvest.",
    "vines.model": "Parameters, words, and what a system is.",
    "vines.dynamics": "Exact runs, their measures, tangent maps and exponents; runs with scatter.",
    "vines.attractors": "What a run settles to, from one start or from many.",
    "vines.orbits": "Periodic orbits, their families, bifurcations and curves; the best orbit; the reduced model.",
    "vines.stages": "Studies: run, ask, draw, compare and export what pipelines declare.",
    "vines.pipeline": "Declarations, kinds, and how a run is planned.",
    "vines.store": "Results under their keys.",
    "vines.schema": "Tables and messages: columns, units, checks.",
    "vines.catalogue": "SQL over all results.",
    "vines.figures": "Figures of numbers that are given.",
    "vines.logs": "Runs as MCAP files.",
    "vines.viewer": "Runs in the Rerun viewer.",
    "vines.rig": "Measured runs: reading, reconstruction, comparison.",
    "vines.errors": "What goes wrong, by kind; each is one of Python's own errors too.",
}
"""The packages of the reference, in the order of its pages, and what each is for."""


_LITERAL = re.compile(r"(``.*?``|`[^`]*`)")


def setup(app: Any) -> None:
    """Let the reference be written before the pages are read, and bars stand for themselves."""
    app.connect("builder-inited", write_reference)
    app.connect("autodoc-process-docstring", escape_bars, priority=900)  # after numpydoc


def escape_bars(app: Any, what: str, name: str, found: Any, options: Any, lines: list[str]) -> None:
    """Escape the bars of ``max|x1|``, which would be a substitution; code stays as it is."""
    code = False
    for k, line in enumerate(lines):
        code = line.lstrip().startswith(">>>") or (code and bool(line.strip()))
        if not code:
            parts = _LITERAL.split(line)
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[k] = "".join(parts)


def write_reference(app: Any) -> None:
    """Write a page for each package of :data:`ROOMS`, and one that lists them, where they are not yet the same."""
    folder = Path(app.srcdir) / "api"
    folder.mkdir(exist_ok=True)
    pages = {f"{name}.rst": _page(name, about) for name, about in ROOMS.items()}
    listed = "\n".join(f"* :doc:`{name} <{name}>`: {_rst(about)}" for name, about in ROOMS.items())
    toctree = "\n".join(f"   {name}" for name in ROOMS)
    head = _title("Python: the reference", "=")
    told = "Everything public, package by package. Names without an underscore in front may be used."
    pages["index.rst"] = f"{head}\n{told}\n\n{listed}\n\n.. toctree::\n   :hidden:\n\n{toctree}\n"
    for file, text in pages.items():
        if not (folder / file).is_file() or (folder / file).read_text("utf-8") != text:
            (folder / file).write_text(text, "utf-8")
    for old in folder.glob("*.rst"):
        if old.name not in pages:
            old.unlink()


def _page(name: str, about: str) -> str:
    package = importlib.import_module(name)
    parts = [_title(name, "="), _rst(about), "", f".. currentmodule:: {name}", ""]
    for each in sorted(package.__all__, key=str.lower):
        found = getattr(package, each)
        if inspect.ismodule(found):
            continue
        home = str(getattr(found, "__module__", name) or name)
        elsewhere = name == "vines" and home.split(".")[1:2] != []
        if inspect.isclass(found):
            parts += [f".. autoclass:: {name}.{each}", "   :members:", *_index(elsewhere), ""]
        elif callable(found) and hasattr(found, "__name__"):
            parts += [f".. autofunction:: {name}.{each}", *_index(elsewhere), ""]
        else:
            parts += [f".. data:: {each}", "", textwrap.indent(_told(name, each), "   "), ""]
    return "\n".join(parts)


def _told(package: str, name: str) -> str:
    """Return what stands below a constant in the file that it comes from."""
    folder = Path(importlib.import_module(package).__file__ or "").parent
    for file in [folder / "__init__.py", *sorted(folder.rglob("_*.py"))]:
        body = ast.parse(file.read_text("utf-8")).body
        for one, following in itertools.pairwise(body):
            names = (
                one.targets if isinstance(one, ast.Assign) else [one.target] if isinstance(one, ast.AnnAssign) else []
            )
            doc = following.value if isinstance(following, ast.Expr) else None
            if any(isinstance(each, ast.Name) and each.id == name for each in names) and isinstance(doc, ast.Constant):
                return _rst(inspect.cleandoc(str(doc.value))).replace("|", r"\|")
    return ""


def _index(elsewhere: bool) -> list[str]:
    """Return the option by which an entry that has another home stands in the index once."""
    return ["   :no-index:"] if elsewhere else []


def _title(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}\n"


def _rst(text: str) -> str:
    return text.replace("`", "``")
