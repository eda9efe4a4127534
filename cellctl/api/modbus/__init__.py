"""The line PLC's interface: register map, Modbus TCP server, command handshake, heartbeats."""
