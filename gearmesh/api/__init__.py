"""What people import: designs, the gears built from them, and the answers to questions about them."""
