"""Pictures of a cell's model: three views on paper, and a file for a 3-D viewer."""
