"""Public interface: designs, gears built from them, and answers to questions about gears."""
