"""Contact of worm and wheel: its lines in closed form, and where it lies on the wheel."""
