"""Finds and fits single round contacts: spots, sub-pixel edges, circles, and tips of pins."""
