"""Where two teeth touch: starts, conditions, path, mesh cycle, Hertz pressure."""
