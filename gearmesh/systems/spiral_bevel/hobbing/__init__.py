"""Face-hobbed spiral bevel and hypoid gears: head, blank and sides by continuous indexing."""
