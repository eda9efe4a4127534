"""What hangs from an arm behind its force sensor: mass, springs, contact, and their reading."""
