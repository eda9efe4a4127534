"""Calls, replies and state frames: bytes to values and back, without I/O."""
