"""The interface to the line PLC: Modbus TCP, with the cell as the server.

A request of the PLC goes ``server`` (connections and frames) -> ``pdu`` (function codes) ->
``register_blocks`` (which addresses may be touched). A write that commits a command goes on to
``latch`` (the handshake), as a ``submission`` into the queue of ``interface``, and from there to
the arbiter. In the other direction ``publisher`` takes a snapshot of the unit, ``status`` names its
values and ``encoding`` turns them into registers. ``register_map`` is the map as data,
``document`` its page.
"""
