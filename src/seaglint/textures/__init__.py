"""Statistical textures: Markov random fields in space and time."""
