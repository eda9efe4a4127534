"""A line PLC: its program, its link to the cell, its own reading of the register map."""
