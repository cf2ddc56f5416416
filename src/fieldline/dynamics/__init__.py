"""What moves: the plant, one right-hand side for bodies and lines under every load."""
