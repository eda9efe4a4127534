"""Planning of a cell offline: whether its moves are free, and ways that are.

Nothing here is loaded by the daemon. A plan goes into the cell file, is read by a person and tried
at low speed. ``model`` reads what stands in the cell, ``scene`` measures distances in it.
"""
