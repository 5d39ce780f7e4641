"""Trimmed teeth and their surfaces; members, their mounting, and the pairs that mesh."""
