"""Contact of worm and wheel: its lines in closed form, and its position on the wheel."""
