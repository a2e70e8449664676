"""Weather statistics: probability of conditions, and of the glint that they bring."""
