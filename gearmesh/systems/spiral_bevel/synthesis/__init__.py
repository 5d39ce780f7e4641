"""Settings that give the requested contact: local synthesis, ease-off, and choices for open keys."""
