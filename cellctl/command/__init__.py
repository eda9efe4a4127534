"""The one path that every command takes, whichever interface it comes from.

The walk of a command:

1. An interface (``api.modbus`` for the line PLC, ``api.local_socket`` for the terminal) turns what
   it received into a ``UnitCommand`` and wraps it in a ``Submission``, through which the interface
   hears how the command ends. The line's commands wait in a ``CommandQueue`` first.
2. ``CommandArbiter.submit`` takes the submission. Stop and Abort skip step 3.
3. The ``CommandValidator`` checks the command. Where the checks succeed, the client's record and an
   acknowledged alarm are written to disk, because neither must be lost once the unit moves.
4. The arbiter lets one command at a time execute. It validates again what may have changed
   meanwhile, and hands an accepted Start to the job factory: the one place where a command becomes
   a job.
5. The ``CommandTracker`` gives the command to the PackML state machine, which validates it once
   more against its tables, and tells the submission when the command has ended.

A reject code is the answer of every step; a numbered fault is raised only when something broke.
"""
