"""Moves of the arm between the steps: from wherever it was left to where a run begins.

All of them run under the force guard. Those that belong to one step stand in that step.
"""
