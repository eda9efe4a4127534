"""Maintenance on this cell: 101 to 109. ``procedure_list`` lists them with their devices."""
