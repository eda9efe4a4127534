"""`cellctl plan`: offline planning of a cell by its model."""
