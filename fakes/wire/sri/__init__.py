"""The interface box of an SRI force sensor: one core, reached over TCP, a serial line or CAN."""
