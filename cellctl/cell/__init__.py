"""The devices of one cell by name, and what can be done with them whatever the process is.

``devices`` builds and connects them; ``robot_layers`` and ``zones`` stand between a command and the
driver of a robot. ``guarded_motion`` moves through free air under force limits, ``contact_motion``
moves in contact. ``lighting`` sees to lamps and exposures. ``standstill`` and ``readiness`` say
whether the cell is unmoved and ready.
"""
