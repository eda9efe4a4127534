"""The connections to one controller, of the daemon and of the guard."""
