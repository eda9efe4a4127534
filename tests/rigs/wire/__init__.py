"""Drivers and what stands in for their controllers, connected through sockets of this PC."""
