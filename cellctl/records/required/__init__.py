"""What a part has to be measured for: figures with their limits, known before its run moves."""
