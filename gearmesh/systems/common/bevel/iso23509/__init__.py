"""Blanks of bevel and hypoid pairs by ISO 23509:2016, with or without offset, at any shaft angle."""
