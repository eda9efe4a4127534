"""From the entry to the seat: feeding, what helps a peg that stands, and what was felt."""
