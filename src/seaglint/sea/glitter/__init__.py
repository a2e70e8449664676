"""Sparkle from the waves: covariance of the slopes of short waves, the share of the sea that mirrors a disc, and its specular points."""
