"""Fake cells: simulated devices behind the real protocols, for demonstrations, tests and tutorials.

``world`` is the physics, ``scenes`` what stands in a cell, ``render`` the pictures, ``wire`` the
bytes, ``demo`` the demonstration; ``cell`` puts them together by a scenario file. Nothing here
imports the controller or its drivers: the fakes are a second reading of the same manuals.
"""
