"""LOWTRAN7 run live: the deck of a case, the engine compiled once, cached results, an atmosphere sampled from them."""
