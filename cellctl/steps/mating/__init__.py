"""The phases of a force-limited mating and what they share."""
