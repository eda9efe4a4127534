"""Pictures of connectors: pins end-on, sockets, marks of a gripper; ``api`` is the entrance."""
