"""Running jobs in PackML states, whatever the process is.

``process`` is the seam that processes plug into and ``steps`` the typed chain that they bring.
``unit`` joins state machine, devices and records; ``jobs.factory`` turns an accepted Start into
a job of production or of maintenance, which ``jobs.runner`` runs and closes exactly once.
"""
