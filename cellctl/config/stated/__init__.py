"""What processes state of themselves for planning offline: their moves and their measurements."""
