"""Objects in the image: position, occlusion, radiance, composition with the sea, and ground truth."""
