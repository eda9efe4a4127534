"""Maintenance on this cell: 101 to 108. ``offered`` lists them with their devices."""
