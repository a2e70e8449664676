"""Objects in the image: their position, what hides them, their radiance, and their ground truth."""
