"""A peg, or the plug of a connector, that touches a plate and goes into its hole."""
