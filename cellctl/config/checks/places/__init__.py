"""Taught poses, and places that follow from a recipe, held against the arm and its tool.

A pose is taught at the arm, a place comes from a drawing. Where the two contradict each other, one
of them has a slip, and the file is where it can be found before an arm drives there.
"""
