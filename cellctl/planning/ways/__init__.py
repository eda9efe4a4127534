"""Ways of arms between two places: where they lead, how near they come to anything, free ones."""
