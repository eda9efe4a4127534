"""Records of SJL/1 and SJL/2: bytes to values and back, without I/O."""
