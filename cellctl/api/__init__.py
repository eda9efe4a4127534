"""How others reach the daemon: the line PLC by Modbus TCP, operators by the local socket."""
