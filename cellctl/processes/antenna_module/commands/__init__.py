"""Offline commands of this process, found by the entry point ``cellctl.command``."""
