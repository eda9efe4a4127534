"""The report of a run for people: HTML with figures and pictures, and the record beside it.

A process imports ``sections`` to make its own pages; everything else of a
report is the same for all runs.
"""
