"""Statistical textures of recordings, and endless sequences of them."""
