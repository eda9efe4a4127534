"""What the demonstrations of single processes add: their cells, live rows and verdicts."""
