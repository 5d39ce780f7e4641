"""Vector algebra in batches, root finders, Newton's method, splines, effort."""
