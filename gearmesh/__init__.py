"""gearmesh: exact gear tooth surfaces, their contact, and meshes proved against them."""

__version__ = "0.1.0"
