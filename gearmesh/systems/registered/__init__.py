"""What each gear system offers, by the name of its folder: loaded with its first design (see `gearmesh.systems.kinds`)."""
