"""Modules with a plug on a tray, a fixed camera that looks up at them, a panel with a socket."""
