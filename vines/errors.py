"""Every error that vines raises on purpose.

Each is a :class:`VinesError` and also a builtin, so that a caller may catch either. The message is one line: what was
wrong, the value, what is allowed, and the remedy. The command line prints that line and exits with
:attr:`VinesError.exit_code`.
"""

from __future__ import annotations

import difflib
import errno
from collections.abc import Iterable

__all__ = [
    "ChunkError",
    "CodeError",
    "DamageError",
    "DamageWarning",
    "DeclarationError",
    "EngineError",
    "FileMissingError",
    "KernelError",
    "LogError",
    "LogVersionError",
    "OrbitNotFound",
    "PackageMissingError",
    "ParameterError",
    "PlugInError",
    "QueryError",
    "RigError",
    "RunFailed",
    "SchemaError",
    "StaleWarning",
    "StateError",
    "StoreError",
    "UnknownNameError",
    "ViewerError",
    "VinesError",
    "is_of_the_machine",
    "nearest",
    "printable",
]


class VinesError(Exception):
    """Base of all errors that vines raises on purpose."""

    exit_code: int = 2


class ParameterError(VinesError, ValueError):
    """A parameter of the model lies outside its allowed range."""


class StateError(VinesError, ValueError):
    """A start state is not one that the model can have, such as a gap ``|w| > 1``."""


class DeclarationError(VinesError, ValueError):
    """A pipeline declaration cannot be read: a misspelt key, a wrong type, stages that need themselves."""


class UnknownNameError(VinesError, LookupError):
    """A pipeline, stage, table, log or column was asked for that does not exist."""


class FileMissingError(VinesError, FileNotFoundError):
    """A file that was named does not exist."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class SchemaError(VinesError, TypeError):
    """Data do not fit the schema under which they should be stored."""


class StoreError(VinesError, RuntimeError):
    """A stored result is missing, damaged, or being written by another process."""


class CodeError(VinesError, RuntimeError):
    """A process runs other code than the key of what it should compute says; nothing that it made is stored."""


class DamageError(StoreError):
    """Something stored is not what was written; the message names it, and the next run makes it again."""


class DamageWarning(UserWarning):
    """An answer is without results that are damaged; the message names them."""


class StaleWarning(UserWarning):
    """What is handed out was computed for another declaration, or with other code, than there is now."""


class EngineError(VinesError, RuntimeError):
    """Whoever should compute is missing, such as the scheduler of dask. What was computed is kept."""

    exit_code: int = 3


class KernelError(VinesError, RuntimeError):
    """The kernels that a task needs could not be compiled."""


class PackageMissingError(VinesError, ModuleNotFoundError):
    """A package that computing does without is needed and not installed; the message says what to install."""


class PlugInError(VinesError, ImportError):
    """What an installed package brings to vines cannot be used."""


class LogError(VinesError, ValueError):
    """An MCAP log is damaged, incomplete, or holds what cannot be decoded.

    The message may quote names from the file; what would act on a terminal is escaped.
    """

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))


class ChunkError(LogError):
    """A chunk of a log is compressed in an unknown way, or unpacks to more than is allowed."""


class LogVersionError(LogError):
    """A log is intact and of another version of the schema."""


class QueryError(VinesError, ValueError):
    """A SQL query could not be answered."""


class ViewerError(VinesError, RuntimeError):
    """The Rerun viewer could not be started or could not draw."""


class ViewerStallError(ViewerError):
    """The Rerun viewer ended, did not answer or did not come to rest in time, which a second start may mend."""


class RigError(VinesError, ValueError):
    """Data of a rig cannot be used: no unit, sign, rate or sensitivity, a clipped signal, clocks that don't agree."""


class OrbitNotFound(VinesError, LookupError):  # noqa: N818 - the name is promised in the design
    """No periodic orbit of the word was found; the message says how near the search came."""

    exit_code: int = 1


class RunFailed(VinesError, RuntimeError):  # noqa: N818 - reads as what happened
    """Some points of a run failed; the rest is stored."""

    exit_code: int = 3


_OF_THE_MACHINE = frozenset(
    getattr(errno, name)
    for name in (
        *("EAGAIN", "EDQUOT", "EIO", "EMFILE", "ENFILE", "ENOLCK"),
        *("ENOMEM", "ENOSPC", "EROFS", "ESTALE", "ETIMEDOUT"),
    )
    if hasattr(errno, name)
)


def is_of_the_machine(error: BaseException) -> bool:
    """Whether an error tells of the machine, such as a full disk or too many open files, and not of what was asked.

    Examples
    --------
    >>> is_of_the_machine(OSError(28, "No space left on device")), is_of_the_machine(FileNotFoundError(2, "no"))
    (True, False)
    """
    return isinstance(error, OSError) and error.errno in _OF_THE_MACHINE


def printable(text: str) -> str:
    r"""Return text with everything escaped that acts on a terminal: line ends, escape codes, turns of direction.

    Parameters
    ----------
    text : str
        Such as a name that stood in a file.

    Examples
    --------
    >>> printable("/a\n\x1b[31mb\u202e µ")
    '/a\\n\\x1b[31mb\\u202e µ'
    """
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape", "surrogatepass").decode() for each in text
    )


_LISTED, _FEW = 40, 12
"""Names up to which a message lists them all, and how many it lists of more."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the tail of a message that helps with a misspelt name.

    Parameters
    ----------
    name : str
        What was written.
    known : iterable of str
        What would have been allowed.

    Returns
    -------
    str
        ``"did you mean 'x'? Allowed: x, y"``, or only the list if nothing is near. Of many names those that are most
        alike are listed, and how many there are.

    Examples
    --------
    >>> nearest("settel", ["settle", "record"])
    "did you mean 'settle'? Allowed: record, settle"
    >>> nearest("a", ["A", "mu"])
    "did you mean 'A'? Allowed: A, mu"
    >>> nearest("zzz", ["settle", "record"])
    'allowed: record, settle'
    """
    names = sorted(known)
    listed = ", ".join(names) if names else "nothing"
    if len(names) > _LISTED:
        alike = sorted(names, key=lambda each: -difflib.SequenceMatcher(None, name.casefold(), each.casefold()).ratio())
        listed = f"{', '.join(alike[:_FEW])}, ... ({len(names)} names)"
    folded = {known_name.casefold(): known_name for known_name in reversed(names)}
    close = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=0.6)
    return f"did you mean {folded[close[0]]!r}? Allowed: {listed}" if close else f"allowed: {listed}"
