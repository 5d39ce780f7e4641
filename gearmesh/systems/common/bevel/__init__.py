"""Parts of all bevel gears: blanks, members from the sides of their teeth, displacements, measures, tolerances."""
