"""The ways to reach the box: TCP, a serial line, CAN. Bytes and descriptors, without waiting."""
