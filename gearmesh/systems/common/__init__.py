"""What gear systems share."""
