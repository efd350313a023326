"""Text of a file as UTF-8, whatever it was written in."""

from __future__ import annotations

import codecs

from vines.errors import RigError

__all__ = ["to_utf8"]

_MARKS = (
    # That of UTF-32 begins with that of UTF-16.
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_WINDOWS = "cp1252"


def to_utf8(data: bytes, stated: str = "") -> tuple[bytes, str]:
    r"""Return text as UTF-8 without byte order mark and with plain line ends, and the encoding that it had.

    Parameters
    ----------
    data : bytes
        Of the whole file.
    stated : str
        Its encoding, where that is known. Else it is found: by a byte order mark, UTF-16 by its zeros, UTF-8, or
        Windows-1252.

    Raises
    ------
    RigError
        If it is no text, or not of that encoding.

    Examples
    --------
    >>> to_utf8("Zeit [µs]\r\n1".encode("cp1252"))
    (b'Zeit [\xc2\xb5s]\n1', 'cp1252')
    >>> to_utf8("1,5".encode("utf-16"))[1]
    'utf-16-le'
    """
    mark, marked = next(((mark, name) for mark, name in _MARKS if data.startswith(mark)), (b"", ""))
    data = data[len(mark) :]
    # A mark says which of the two orders of bytes a stated utf-16 is.
    name = marked if stated.casefold() in ("utf-16", "utf16", "utf-32", "utf32") else ""
    name = name or stated or marked or _wide(data[:4096])
    if name.startswith("utf-16"):
        # A recorder that was switched off may have written half a character.
        data = data[: len(data) // 2 * 2]
    if not name:
        if b"\0" in data[:65536]:
            raise RigError("it is no text: it holds zero bytes")
        name = "utf-8" if _is_utf8(data) else _WINDOWS
    try:
        text = data if name == "utf-8" and _is_utf8(data) else data.decode(name).encode()
    except LookupError:
        raise RigError(f"encoding {name!r} is not known, such as utf-8, utf-16, cp1252, shift_jis") from None
    except UnicodeError:
        hint = "write encoding=... into the column dialect of channels.tsv, such as encoding=shift_jis"
        found = (
            f"it is not of encoding {name}" if stated or marked else "it is neither UTF-8, UTF-16 nor Windows-1252 text"
        )
        raise RigError(f"{found}: {hint}") from None
    if b"\r" in text:
        text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return text.removeprefix(codecs.BOM_UTF8), name


def _wide(head: bytes) -> str:
    """Return which UTF-16 the first bytes are without a mark: of plain text every second byte is zero."""
    half = len(head) // 2
    if half and head[1::2].count(0) > 0.7 * half and not head[0::2].count(0):
        return "utf-16-le"
    if half and head[0::2].count(0) > 0.7 * half and not head[1::2].count(0):
        return "utf-16-be"
    return ""


def _is_utf8(data: bytes) -> bool:
    if data.isascii():
        return True
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
