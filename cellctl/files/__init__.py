"""Files on the disk of the cell's PC: written so that a power cut spoils none, read as people leave
them."""
