"""What the peg has met at its first contact and after its entry, and what follows from it."""
