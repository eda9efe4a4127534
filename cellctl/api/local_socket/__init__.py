"""The local API: operators at the cell's PC command the daemon through a Unix-domain socket.

A request goes ``server`` (connections and lines) -> ``messages`` (JSON to a typed request) ->
``terminal``, which submits a command to the arbiter or has ``reporter`` compile the status.
``socket_file`` and ``users`` say who may connect and who asks.
"""
