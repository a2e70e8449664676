"""Air from spectra at nodes: somebody's own calculation or measurement."""
