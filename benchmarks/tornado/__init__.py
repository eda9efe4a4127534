"""What each imperfection of the fake cell costs, and whether the cell notices it.

Run with ``make campaign-tornado``. Each imperfection of ``fakes.imperfections`` alone, at once,
twice and five times its realistic size, then all together. What acts on force and contact alone is
tried on the mating campaign's cell, which takes a tenth of the time; all else, and all together, on
the whole cell.
"""
