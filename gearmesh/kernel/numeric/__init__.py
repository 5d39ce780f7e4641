"""Vectors in batches, root finders, Newton, effort."""
