"""Light that a tilted patch of sea mirrors and emits, for means and for images.

Two quadratures compute it, each the other's check:

- averages over slope statistics: ``legs``, :mod:`~seaglint.facet.glint`, :mod:`~seaglint.facet.emissivity`,
  ``scattered``;
- the facets of a synthesised sea with roughness on them: ``facet_sunlight``, ``solar_disc``,
  ``thermal``, ``mirrored_haze``.
"""
