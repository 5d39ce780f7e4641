"""Whether gears fit: backlash, clearance of tips, interference, and what frees a pair."""
