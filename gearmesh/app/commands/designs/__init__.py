"""Commands about designs: new designs, samples, derived values, settings."""
