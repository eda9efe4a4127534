"""Tasks that nobody has thought of: parts, holes, cells and truths within what a recipe may say.

The cell is told what a drawing and a commissioning would tell it, with bounds that are a little
wide; what is wrong with a truth it is not told.
"""
