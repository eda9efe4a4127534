"""Contact under a stream of setpoints: the admittance law, its gains, and the rules of its ticks.

Pure functions and small state classes on numbers and arrays; section 4 of the study of insertion by
touch has the derivations. Vectors of six hold three translations (m, N) and three rotations (rad,
N·m), in the axes of the task and about the tip of the peg.
"""
