"""Contact of two teeth: starts, conditions, path, mesh cycle, Hertz pressure."""
