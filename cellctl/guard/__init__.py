"""The force guard: a process that watches one force sensor and stops one robot.

A cell has as many guards as it has force sensors that must be able to stop a robot; they share
nothing. A guard protects parts, not people. docs/guard.md describes it.

This folder is the daemon's side, with ``client`` as the way in, and what both sides share:
``limits``, ``report``, ``messages`` and the memory layout in ``ring``. ``watch`` is what runs
inside the guard process. Whatever ``watch`` imports must not load numpy, scipy or asyncio.
"""
