"""System C: a pin or a connector finds its hole by touch."""
