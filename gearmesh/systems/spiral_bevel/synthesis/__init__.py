"""Settings that give the contact asked for: local synthesis, ease-off, and what is chosen where a design leaves it open."""
