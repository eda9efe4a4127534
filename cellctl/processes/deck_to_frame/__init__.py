"""System A: a deck is measured, corrected and mated onto its frame, under force.

The names follow the paper: D is the deck, M the frame, F (``flange``) the flange of the main
robot, C1 (``c1``) the left camera of head I, B (``base``) the base of the main robot.

Read in this order: ``process`` (what the core asks for), ``roles`` and ``recipe`` (what the cell
file says), ``state`` (what each step hands to the next), ``steps`` (one file a step), ``poses``
(measuring and correcting), ``mating`` (contact), ``moves`` (clearing the station), ``record``
and ``report`` (what is kept), ``procedures`` (Maintenance) and ``checks`` (before anything runs).
"""
