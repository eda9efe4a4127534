"""`python -m cellctl.hmi`."""

from cellctl.hmi.main import main

main()
