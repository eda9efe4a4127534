"""The rim of a hole: located by its edges, measured by fitting what it looks like."""
