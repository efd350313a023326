"""Style sheets of matplotlib, read before anything is drawn with them."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from vines.errors import DeclarationError, FileMissingError, nearest

__all__ = ["Told", "style_settings"]


def style_settings(style: str | Path) -> dict[Any, Any]:
    """Return the settings of a style.

    Parameters
    ----------
    style : str or Path
        A file ending in ``.mplstyle``, or the name of a style that matplotlib knows.

    Raises
    ------
    FileMissingError
        If there is no such file.
    DeclarationError
        If there is no style of that name, a line of the file is none of matplotlib's settings, or none of the fonts
        that it names is installed.
    """
    import matplotlib as mpl
    from matplotlib import font_manager
    from matplotlib import style as styles

    path = Path(style).expanduser()
    if path.suffix == ".mplstyle":
        if not path.is_file():
            raise FileMissingError(f"{style}: there is no such style sheet")
        with Told("matplotlib") as told:
            try:
                found = dict(mpl.rc_params_from_file(path, use_default_template=False))
            except (OSError, UnicodeDecodeError, ValueError) as error:
                raise DeclarationError(f"{style}: {' '.join(str(error).split())}") from None
        if told.lines:
            raise DeclarationError(f"{style}: {told.lines[0]}")
    elif str(style) in styles.library:
        found = dict(styles.library[str(style)])
    else:
        known = nearest(str(style), styles.available)
        raise DeclarationError(f"no style {str(style)!r}: {known}; or a file that ends in .mplstyle")
    with mpl.rc_context(found):
        try:
            font_manager.findfont(font_manager.FontProperties(), fallback_to_default=False)
        except ValueError:
            family = ", ".join(mpl.rcParams["font.family"])
            raise DeclarationError(
                f"{style}: none of the fonts of {family!r} is installed; install one, or name DejaVu Sans"
            ) from None
    return found


class Told(logging.Handler):
    """What a logger warns of while this is entered: kept, and not shown."""

    def __init__(self, name: str) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []
        self._logger = logging.getLogger(name)

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(" ".join(record.getMessage().split()))

    def __enter__(self) -> Told:
        self._logger.addHandler(self)
        self._kept, self._logger.propagate = self._logger.propagate, False
        return self

    def __exit__(self, *_: object) -> None:
        self._logger.removeHandler(self)
        self._logger.propagate = self._kept
