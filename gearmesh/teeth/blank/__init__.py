"""What limits the teeth and what they stand on."""
