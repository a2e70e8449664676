"""Bodies on and above the sea: shapes, materials, motion, floating, and their images."""
