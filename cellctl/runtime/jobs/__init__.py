"""One job of the unit: made from a Start, recorded from before the first move to its end."""
