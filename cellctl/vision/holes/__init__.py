"""Finding the holes of a part in a stereo pair, and saying which is which.

``search`` looks for round ``candidates`` in the whole images or in windows round a predicted pose,
``correspondence`` pairs them between the cameras and assigns them to the drawing, ``locate`` finds
each rim by its edges. ``plane_normal`` and ``plane_from_edges`` say in which plane the rims lie,
``drawing_fit`` whether what was measured fits the drawing and nothing else does, and ``diagnose``
names the fault when nothing fits.
"""
