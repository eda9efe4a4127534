"""The interfaces of the daemon to the outside.

``modbus`` serves the line PLC, ``local_socket`` the operators at the cell's own PC. Both only
translate: what they receive becomes a ``UnitCommand`` for ``CommandArbiter.submit``, and what they
show comes from the unit's status. A further interface needs no change outside its own folder except
a ``Source`` of its own and its start in the daemon.
"""
