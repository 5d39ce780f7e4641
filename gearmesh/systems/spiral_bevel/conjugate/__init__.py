"""Conjugate spiral bevel gears, Geometry I and II [CR3553 chapter 2]."""
