"""Two stereo heads in the base of a robot, through one target board."""
