"""Data that VTK draws, and the process in which it draws them."""
