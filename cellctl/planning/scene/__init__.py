"""Where the bodies of a cell are at given joints, and how near they come to each other."""
