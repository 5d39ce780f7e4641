"""Commands about teeth in contact, their limits, and many assemblies."""
