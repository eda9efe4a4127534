"""The devices of one cell by name, and what can be done with them whatever the process is.

``devices`` builds and connects them; ``guarded_moves`` runs moves under force limits; ``zones``
keeps two arms out of one space; ``settling``, ``standstill`` and ``readiness`` say whether the
cell is still, unmoved and ready.
"""
