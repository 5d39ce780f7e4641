"""Parts that several gear systems share."""
