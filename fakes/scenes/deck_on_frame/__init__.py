"""A deck that hangs from a robot, above the frame that it is to be mated with."""
