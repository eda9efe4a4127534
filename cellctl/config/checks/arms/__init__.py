"""What the files of a cell say of its arms, held against how arms are made and how far they reach.

The table of links, the boxes of the flange and the limits of the joints bound every move. A slip in
them is seldom seen at a taught pose, and a bound that is too wide protects nothing.
"""
