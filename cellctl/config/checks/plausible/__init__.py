"""Figures that are possible and in all likelihood slips.

`cellctl check` refuses them; a daemon takes them. A cell that has worked for a year must start
after an update, and some of these rules a later kind of cell may break with a reason.
"""
