"""What measured cylindrical gears are evaluated by."""
