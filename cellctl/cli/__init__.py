"""The command line `cellctl`; every command loads only what it needs."""
