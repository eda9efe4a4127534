"""From drawing, recipe and figures of the cell to the plan of one cycle, before anything moves.

``task`` is the drawing in numbers, ``parameters`` what follows from it for a search, each figure
with its formula (``derived``). ``choice`` takes the search that suits, or refuses; ``cycle_plan``
puts everything together.
"""
