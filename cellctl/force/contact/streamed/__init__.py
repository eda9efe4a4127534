"""Contact under a stream of setpoints: the admittance law, its gains, and the rules of its ticks.

Pure functions and small state classes on numbers and arrays; section 4 of the study of insertion by
touch has the derivations (docs/insertion-by-touch.md says what the process makes of them). Vectors
of six hold three translations (m, N) and three rotations (rad, N·m), in the axes of the task and
about the tip of the peg.

The walk of one tick: ``ticks`` says whether the tick may move at all, ``wrench_filter`` has the
newest force, ``admittance`` makes the displacement that gives way to it, with ``gains`` from what
``identification`` has measured, and ``path`` and ``speeds`` say how far the motion itself goes.
"""
