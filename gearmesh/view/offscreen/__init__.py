"""What VTK is given to draw, and the process in which it draws."""
