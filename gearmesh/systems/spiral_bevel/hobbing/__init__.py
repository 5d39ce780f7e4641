"""Face-hobbed spiral bevel gears: head, blank and sides by continuous indexing."""
