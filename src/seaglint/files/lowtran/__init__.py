"""LOWTRAN7 run live: the deck of a case, the engine compiled once, results kept on disk, an atmosphere sampled from them."""
