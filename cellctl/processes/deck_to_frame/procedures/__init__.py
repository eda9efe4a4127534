"""Maintenance on this cell: 101 to 109. ``offered`` lists them with their devices."""
