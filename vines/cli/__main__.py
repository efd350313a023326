"""``python -m vines.cli``: the command line without its script."""

from vines.cli import main

main()
