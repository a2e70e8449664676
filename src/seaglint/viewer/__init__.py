"""Look at scenes and sequences in a browser; needs the extra ``viewer``."""
