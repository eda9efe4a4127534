"""The verdict of an insertion from a file: the curve, what was inserted, and what it felt like."""
