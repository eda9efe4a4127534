"""Maintenance procedures for any cell: they are given the devices that they work with.

A process offers them by number with its own devices (``Process.procedures``) and sees to it that
nothing stands in the way before they begin.
"""
