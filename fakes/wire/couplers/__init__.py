"""Modbus couplers: bare digital inputs and outputs, and a gripper wired to one."""
