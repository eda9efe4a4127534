"""A peg or a plug in the fingers of one arm, and a socket that nobody sees any more."""
