"""``python -m vines``: the command line without its script."""

from vines.cli import main

main()
