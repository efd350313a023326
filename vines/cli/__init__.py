"""The command line: parse, call one function, print.

Nothing is imported here, so that Ctrl-C while the rest is loaded ends in one line, as it does later.
"""

__all__ = ["main"]

_STOPPED = 130
"""As `vines.cli._interrupt.STOPPED`, which may not be loaded yet."""


def main(*, supervised: bool = True) -> None:
    """Run the command line; every expected error ends as one line and its exit code.

    Parameters
    ----------
    supervised : bool
        Whether it goes on in a child process, which a signal ends even inside a kernel or a query.
    """
    waited_for = _by_nobody
    try:
        from vines.cli._app import run
        from vines.cli._supervised import is_supervised as waited_for

        run(supervised=supervised)
    except KeyboardInterrupt:
        import os

        if not waited_for():  # else the process that waits tells it
            os.write(2, b"vines: stopped\n")
        raise SystemExit(_STOPPED) from None


def _by_nobody() -> bool:
    return False
