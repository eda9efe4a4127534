"""SRI six-axis sensors behind an M8128-family interface box."""
