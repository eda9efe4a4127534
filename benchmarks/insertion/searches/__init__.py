"""Search strategies side by side over a height map, as in the table of the study."""
