"""``python -m cellctl`` is the command line."""

from cellctl.cli.app import main

main()
