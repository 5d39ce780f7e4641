"""Registration of the gear systems, by folder; each is loaded with its first design (see `gearmesh.systems.kinds`)."""
