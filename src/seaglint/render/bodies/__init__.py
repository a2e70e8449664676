"""Objects in the picture: where they stand in it, what hides them, what they send, and what is true of them."""
