"""Whether a peg is inserted: what is measured for it, and the judgement."""
