"""How fast one motion in contact may go, and what ends it: asked at each tick, without any I/O."""
