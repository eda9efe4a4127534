"""Moves of a robot while its force guard is armed, and what surrounds them.

``guarded_moves`` arms the guard round moves of any kind, ``free_moves`` are those through free air,
which ``hanging_load`` lets begin only where nothing but a load makes their zero.
``guard_limits`` says how far off a limit must be from noise, ``settling`` waits until the load no
longer swings, and ``leaving`` says whether an arm that presses on something may leave by itself.
``kept_zero`` knows over a restart what an arm pulls or presses with.
"""
