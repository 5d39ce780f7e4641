"""Surfaces by their jets: what they are, mapped, twisted, of revolution; curvature; levels that bound them."""
