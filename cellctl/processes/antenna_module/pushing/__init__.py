"""The live insertion: the arm goes down in short guarded moves, and out again where that fails.

- ``way``: flange poses by depth
- ``attempt``: devices, limits and recorder of one insertion
- ``push_in``: from the stand-off to the seat
- ``back_out``: straight out after a fault
- ``draw_out``: the same without a run, for a Reset
"""
