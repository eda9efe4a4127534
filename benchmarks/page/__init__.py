"""The operator page of a whole fake cell: its pictures, and what many readers cost the cell."""
