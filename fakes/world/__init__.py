"""Physics of the devices, whatever the cell: arms, force sensors, cameras' places, trackers.

Time is an argument; there is no I/O and no clock. ``world`` advances a whole cell, ``truth`` draws
what is wrong with its devices, ``load`` is what hangs from a flange and what it touches.
"""
