"""The force guard: a process of its own that watches the wrench and stops the robot.

It protects parts. ``client`` is the daemon's side, ``process`` the guard's; docs/guard.md explains.
"""
