"""How fast images come from cameras to the daemon."""
