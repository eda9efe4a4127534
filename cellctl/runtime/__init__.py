"""Running jobs in PackML states, whatever the process is.

``process`` is the seam that processes plug into and ``steps`` the typed chain that they bring.
``unit`` joins state machine, devices and records; ``job_factory`` turns an accepted Start into a
``production`` or a ``maintenance`` job, which the ``job_runner`` runs and closes exactly once.
"""
