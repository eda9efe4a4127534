"""The long-running process: wires devices, state machine, line and records together."""
