"""What an assembly adds to the report of its run: tiles, holes, loop, forces, pin holes."""
