"""Light that a tilted patch of sea mirrors and emits, for means and for images.

Two quadratures compute it, each the other's check:

- averages over slope statistics: :mod:`~seaglint.facet.legs`, :mod:`~seaglint.facet.glint`, :mod:`~seaglint.facet.emissivity`,
  :mod:`~seaglint.facet.scattered`;
- the facets of a synthesised sea with roughness on them: :mod:`~seaglint.facet.facet_sunlight`, :mod:`~seaglint.facet.solar_disc`,
  :mod:`~seaglint.facet.thermal`, :mod:`~seaglint.facet.mirrored_haze`.
"""
