"""Second routes and helpers that several tests share."""
