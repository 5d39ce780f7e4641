"""Commands about designs: new ones, samples, what is derived, settings."""
