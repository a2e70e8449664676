"""The sea of :mod:`mitsuba_scene` rendered by Mitsuba 3 on the processor (its LLVM variant and Embree).

Mitsuba finds what is seen and what is lit: primary rays through random points of every pixel against a triangle mesh of the tile, repeated
as instances, and from each hit a ray to a random point of the solar disc. The facet is ours, evaluated at the hit for the sampled point of
the disc: Gaussian roughness about the sea's slope, read linearly from the mesh's lattice, over the visible area A+ and with the roughness'
own shadowing of both legs, by the law of nested bands off the Sun's plane as in it. Mitsuba's own microfacet models are other
functions.

The Earth is bent as in our renderer: each instance is sheared so that its corners lie on the parabola of the effective Earth, and the mesh
has the parabola over its chord, which is the same for all tiles, so that neighbours join exactly; the shading is done in the local frame
of the hit.

Written to Mitsuba 3.9; it needs an LLVM library (Debian: libllvm19; 15 and 16 crash on processors with AVX512-FP16).
"""

from __future__ import annotations

import ctypes
import ctypes.util
import importlib.util
import math
import os
from dataclasses import replace
from glob import glob
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mitsuba_scene import RANGE, facets_left
from seaglint.base.constants import EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Camera
from seaglint.optics.fresnel import reflectance
from seaglint.sea.shadowing.nested import HIGHEST, LOWEST, NO_SHELTER, SLACK_ENDS, nested_ratio
from seaglint.sea.shadowing.seen_and_lit import coupling_table
from seaglint.sea.wave_field import WaveField

INCIDENCE_NODES = 1025
LIFT = 3e-4
"""Start of the rays to the Sun above the surface [m]. Single precision leaves about 1 mm along a ray at 14 km, a tenth of that in height;
a lift of 2 mm lights 0.15 % too much under a Sun at 80 deg, this one 0.03 %."""

SLOPE_AXIS, EDGE_AXIS = (-6.5, 6.5, 521), (0.0, 6.0, 241)
"""First, last and number of nodes of the table of nested shadowing; read linearly, within 1e-4."""

LLVM_VERSIONS = (19, 20, 18, 17)
"""Versions of LLVM looked for, best first."""

RAYS_AT_ONCE = 4 * 1024 * 512


class MitsubaMissingError(RuntimeError):
    """Mitsuba or its LLVM library is missing; the text says which, and how to get it."""


def load_mitsuba() -> tuple[Any, Any]:
    """The modules ``mitsuba`` and ``drjit``, with the LLVM variant set.

    Raises
    ------
    MitsubaMissingError
        With what is missing and how to get it.
    """
    if importlib.util.find_spec("mitsuba") is None:
        raise MitsubaMissingError("Mitsuba is not installed: pip install 'mitsuba>=3.9'")
    library = os.environ.get("DRJIT_LIBLLVM_PATH") or llvm_library()
    if library is None:
        raise MitsubaMissingError("no LLVM library for Mitsuba: apt-get install libllvm19, or set DRJIT_LIBLLVM_PATH")
    try:
        ctypes.CDLL(library)
    except OSError as error:
        raise MitsubaMissingError(f"the LLVM library {library} cannot be loaded ({error}): apt-get install libllvm19") from error
    os.environ["DRJIT_LIBLLVM_PATH"] = library
    try:
        import drjit as dr
        import mitsuba as mi

        mi.set_variant("llvm_ad_mono")
    except (ImportError, AttributeError) as error:
        raise MitsubaMissingError(f"Mitsuba cannot be loaded ({error}): pip install 'mitsuba>=3.9'") from error
    return mi, dr


def llvm_library() -> str | None:
    """Path or name of an LLVM library that Mitsuba works with; None where there is none."""
    for n in LLVM_VERSIONS:
        for folder in ("/usr/lib/*", f"/usr/lib/llvm-{n}/lib"):
            for path in sorted(glob(f"{folder}/libLLVM*{n}*")):
                return path
    return ctypes.util.find_library("LLVM")


class MitsubaSea:
    """The tile as instances, the camera and the Sun; make it once, :meth:`update` it for each frame, then :meth:`render`.

    Parameters
    ----------
    view : SeaView
        Sea and Sun, without air.
    camera : Camera
        Image grid.
    waves : WaveField
        One tile without turn.
    threads : int, optional
        Threads of Dr.Jit and Embree.
    nested_bands : float, optional
        Bands of the facets' nested shadowing; those that the renderer compared has, where none are given, and 1 for Smith's.
    subdivision : int
        Parts of a lattice cell's side in the mesh, which holds the sea itself at their corners. A cell is a curved patch of a spline to
        the sweep; two flat triangles in its place move what is seen at a grazing view, and more of them come closer to the patch.
    """

    def __init__(
        self,
        view: SeaView,
        camera: Camera,
        waves: WaveField,
        threads: int | None = None,
        *,
        nested_bands: float | None = None,
        subdivision: int = 1,
    ) -> None:
        self.mi, self.dr = load_mitsuba()
        if threads is not None:
            self.dr.set_thread_count(threads)
        if len(waves.tiles) != 1 or waves.tiles[0].rotation != 0.0:
            raise ValueError("one tile without turn is wanted")
        self.camera, self.waves = camera, waves.refined(subdivision)
        self.tile = self.waves.tiles[0]
        self.roughness, law = facets_left(view, waves)
        if nested_bands is not None:
            law = replace(law, bands=nested_bands, shelter=law.shelter if nested_bands > 1.0 else NO_SHELTER)
        bands = max(law.bands, 1.0)
        self.nested, self.shelter = self._nested_table(bands), law.shelter
        coupling = coupling_table(bands, law.deviation)
        self.coupling = self.mi.Float(coupling.astype(np.float32).ravel()) if coupling.size else None
        self.coupling_shape = coupling.shape
        self.in_the_way = min(law.bands, 1.0)
        index = view.water.index(view.in_band.wavenumber_cm)
        cosines = np.linspace(0.0, 1.0, INCIDENCE_NODES)
        sunlight = reflectance(cosines[:, None], index) @ (view.irradiance * view.in_band.weights)
        self.reflected = self.mi.Float(sunlight.astype(np.float32))
        self.sun_zenith, self.sun_azimuth = view.solar_zenith, view.solar_azimuth
        self.scene = self._build()
        self.parameters = self.mi.traverse(self.scene)
        self.vertices = next(key for key in self.parameters.keys() if key.endswith("vertex_positions"))  # noqa: SIM118
        self.slope_east = self.slope_north = self.mi.Float(0.0)
        self.update(0.0)

    def _nested_table(self, bands: float) -> Any:
        """Logarithm of the visible density over Smith's, edges (rows) and slopes (columns) in rms slopes; None where they are the same."""
        if bands <= 1.0:
            return None
        slope, edge = np.linspace(*SLOPE_AXIS), np.linspace(*EDGE_AXIS)
        logarithm = np.log(np.maximum(nested_ratio(slope, np.arctan2(1.0, edge)[:, None], 1.0, bands), 1e-30))
        return self.mi.Float(logarithm.astype(np.float32).ravel())

    def _build(self) -> Any:
        mi, n = self.mi, self.tile.n
        mesh = mi.Mesh("tile", (n + 1) ** 2, 2 * n * n, has_vertex_normals=False, has_vertex_texcoords=False)
        parameters = mi.traverse(mesh)
        corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).astype(np.uint32)
        faces = np.stack([corner, corner + 1, corner + n + 2, corner, corner + n + 2, corner + n + 1], axis=-1)
        parameters["vertex_positions"] = mi.Float(self._positions(np.zeros((self.tile.n, self.tile.n), np.float32)))
        parameters["faces"] = mi.UInt32(faces.ravel())
        parameters.update()
        scene: dict[str, Any] = {"type": "scene", "sea": {"type": "shapegroup", "tile": mesh}}
        for i, j in self._cells():
            scene[f"at_{i}_{j}".replace("-", "m")] = {
                "type": "instance",
                "to_world": mi.ScalarTransform4f(self._placed(i, j)),
                "shapegroup": {"type": "ref", "id": "sea"},
            }
        return mi.load_dict(scene)

    def _cells(self) -> list[tuple[int, int]]:
        """Tiles (east, north) that the field of view touches out to :data:`~mitsuba_scene.RANGE`, and their neighbours, which can shade."""
        camera, length = self.camera, self.tile.length
        azimuth = camera.azimuth + np.linspace(-0.5, 0.5, 41) * camera.width
        arc = np.arange(0.0, RANGE, 0.1 * length)
        east, north = np.outer(np.sin(azimuth), arc), np.outer(np.cos(azimuth), arc)
        # a crest of 5 m shades no farther than this under the Suns compared
        margin = 5.0 * min(math.tan(self.sun_zenith), 50.0)
        cells = set()
        for de in (-margin, margin):
            for dn in (-margin, margin):
                i, j = np.floor((east + de) / length).astype(int).ravel(), np.floor((north + dn) / length).astype(int).ravel()
                cells.update(zip(i.tolist(), j.tolist(), strict=True))
        return sorted(cells)

    def _placed(self, i: int, j: int) -> NDArray[np.float64]:
        """Tile to world: moved, and sheared onto the chords of the effective Earth's parabola."""
        length, radius = self.tile.length, EFFECTIVE_EARTH_RADIUS
        x, y = i * length, j * length
        matrix = np.eye(4)
        matrix[:3, 3] = x, y, -(x * x + y * y) / (2.0 * radius)
        matrix[2, 0], matrix[2, 1] = -(2.0 * x + length) / (2.0 * radius), -(2.0 * y + length) / (2.0 * radius)
        return matrix

    def _positions(self, height: NDArray[np.float32]) -> NDArray[np.float32]:
        n = self.tile.n
        out = np.empty((n + 1, n + 1, 3), np.float32)
        axis = np.arange(n + 1, dtype=np.float32) * np.float32(self.tile.spacing)
        out[..., 0], out[..., 1] = axis, axis[:, None]
        out[:n, :n, 2] = height
        out[n, :n, 2], out[:n, n, 2], out[n, n, 2] = height[0], height[:, 0], height[0, 0]
        bulge = axis * (np.float32(self.tile.length) - axis) / np.float32(2.0 * EFFECTIVE_EARTH_RADIUS)
        out[..., 2] += bulge + bulge[:, None]
        return out.ravel()

    def update(self, time: float) -> None:
        """Waves, vertices and acceleration structure of the instant ``time`` [s]."""
        surface = self.waves.surfaces(time, workers=self.dr.thread_count())[0]
        self.parameters[self.vertices] = self.mi.Float(self._positions(surface[..., 0]))
        self.parameters.update()
        self.slope_east = self.mi.Float(np.ascontiguousarray(surface[..., 1]).ravel())
        self.slope_north = self.mi.Float(np.ascontiguousarray(surface[..., 2]).ravel())
        self.dr.eval(self.slope_east, self.slope_north)
        self.dr.sync_thread()

    def render(self, samples: int, seed: int = 0, *, stratified: bool = True) -> NDArray[np.float64]:
        """Reflected sunlight, (rows, columns) [W m-2 sr-1], of ``samples`` rays a pixel.

        ``stratified`` rays go through one random point in each cell of a square division of the pixel, and their number is a square;
        others through points independent of each other, as Mitsuba's default sampler has them.
        """
        side = math.isqrt(samples) if stratified else 1
        if stratified and side * side != samples:
            raise ValueError(f"samples = {samples} is no square")
        pixels = self.camera.rows * self.camera.columns
        passes = max(1, math.ceil(pixels * samples / RAYS_AT_ONCE))
        while samples % passes:
            passes += 1
        total = np.zeros(pixels)
        for i in range(passes):
            total += np.asarray(self._pass(side, samples // passes, i * (samples // passes), seed * 1009 + i), dtype=np.float64)
        return (total / samples).reshape(self.camera.rows, self.camera.columns)

    def _pass(self, side: int, batch: int, first: int, seed: int) -> Any:
        """Sum of ``batch`` rays in every pixel, those of the ``side`` x ``side`` strata from ``first`` on."""
        mi, dr, camera = self.mi, self.dr, self.camera
        count = camera.rows * camera.columns * batch
        ray_number = dr.arange(mi.UInt32, count)
        pixel = ray_number // batch
        stratum = ray_number - pixel * batch + first
        random = mi.PCG32(size=count, initstate=seed, initseq=1)
        column, row = pixel % camera.columns, pixel // camera.columns
        x = (mi.Float(stratum % side) + random.next_float32()) / side
        y = (mi.Float(stratum // side % side) + random.next_float32()) / side
        azimuth = (mi.Float(column) + x) * camera.column_step + (camera.azimuth - 0.5 * camera.width)
        elevation = camera.top - (mi.Float(row) + y) * camera.row_step
        sin_a, cos_a = dr.sincos(azimuth)
        sin_e, cos_e = dr.sincos(elevation)
        ray = mi.Ray3f(mi.Point3f(0.0, 0.0, camera.height), mi.Vector3f(cos_e * sin_a, cos_e * cos_a, sin_e))
        hit = self.scene.ray_intersect_preliminary(ray)
        seen = hit.is_valid()
        p = ray(dr.select(seen, hit.t, 1.0))  # rays into the sky go on with harmless numbers and count for nothing
        # local frame of the round sea, to first order in range over radius
        radius = EFFECTIVE_EARTH_RADIUS
        tilt_e, tilt_n = p.x / radius, p.y / radius
        d = ray.d
        view = mi.Vector3f(d.z * tilt_e - d.x, d.z * tilt_n - d.y, -d.z - d.x * tilt_e - d.y * tilt_n)
        # carried along the line of sight to a vertical that turns with the true radius: the effective one stands for refraction
        turn_e, turn_n = p.x / EARTH_RADIUS, p.y / EARTH_RADIUS
        foot = self._sun_sample(random)
        sun = dr.normalize(mi.Vector3f(foot.x - foot.z * turn_e, foot.y - foot.z * turn_n, foot.z + foot.x * turn_e + foot.y * turn_n))
        shadow = mi.Ray3f(
            mi.Point3f(p.x, p.y, p.z + LIFT),
            mi.Vector3f(sun.x + sun.z * tilt_e, sun.y + sun.z * tilt_n, sun.z - sun.x * tilt_e - sun.y * tilt_n),
        )
        lit = ~self.scene.ray_test(shadow, seen)
        value = dr.select(seen & lit, self._facet(p, view, sun), 0.0)
        return dr.block_sum(value, batch)

    def _sun_sample(self, random: Any) -> Any:
        """A direction to a point of the disc at the sensor's foot, evenly over it."""
        mi, dr = self.mi, self.dr
        z, a = self.sun_zenith, self.sun_azimuth
        radius = SOLAR_ANGULAR_RADIUS * dr.sqrt(random.next_float32())
        s, c = dr.sincos(2.0 * math.pi * random.next_float32())
        centre = mi.Vector3f(math.sin(z) * math.sin(a), math.sin(z) * math.cos(a), math.cos(z))
        up = mi.Vector3f(-math.cos(z) * math.sin(a), -math.cos(z) * math.cos(a), math.sin(z))
        side = mi.Vector3f(math.cos(a), -math.sin(a), 0.0)
        return dr.normalize(centre + radius * (c * up + s * side))

    def _slopes(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Bilinear slopes of the periodic lattice."""
        mi, dr, n = self.mi, self.dr, self.tile.n
        u, v = x * (1.0 / self.tile.spacing), y * (1.0 / self.tile.spacing)
        floor_u, floor_v = dr.floor(u), dr.floor(v)
        fu, fv = u - floor_u, v - floor_v
        # n is a power of two in this scene: two's complement wraps negative indices
        i, j = mi.UInt32(mi.Int32(floor_u) & (n - 1)), mi.UInt32(mi.Int32(floor_v) & (n - 1))
        i1, j1 = (i + 1) & (n - 1), (j + 1) & (n - 1)

        def read(lattice: Any) -> Any:
            low = (1.0 - fu) * dr.gather(mi.Float, lattice, j * n + i) + fu * dr.gather(mi.Float, lattice, j * n + i1)
            high = (1.0 - fu) * dr.gather(mi.Float, lattice, j1 * n + i) + fu * dr.gather(mi.Float, lattice, j1 * n + i1)
            return (1.0 - fv) * low + fv * high

        return read(self.slope_east), read(self.slope_north)

    def _nested_factor(self, slope: Any, edge: Any) -> Any:
        """Density over Smith's that one leg leaves, for a slope towards it and the edge, both from the facet's tilt and in rms slopes."""
        mi, dr = self.mi, self.dr
        if self.nested is None:
            return mi.Float(1.0)

        def place(value: Any, axis: tuple[float, float, int]) -> tuple[Any, Any]:
            x = (dr.clip(value, axis[0], axis[1]) - axis[0]) * ((axis[2] - 1) / (axis[1] - axis[0]))
            i = mi.UInt32(dr.minimum(x, axis[2] - 1.001))
            return i, x - mi.Float(i)

        (j, f), (i, g) = place(slope, SLOPE_AXIS), place(edge, EDGE_AXIS)
        n = SLOPE_AXIS[2]

        def row(i: Any) -> Any:
            return (1.0 - f) * dr.gather(mi.Float, self.nested, i * n + j) + f * dr.gather(mi.Float, self.nested, i * n + j + 1)

        ratio = dr.exp((1.0 - g) * row(i) + g * row(i + 1))
        return dr.select(edge < EDGE_AXIS[1], ratio, 1.0)

    def _coupling_factor(self, slope: Any, view: Any, sun: Any) -> Any:
        """Facets seen and lit over the product of both legs alone; slope and elevations of viewer and Sun from the facet, in rms slopes."""
        mi, dr = self.mi, self.dr
        if self.coupling is None:
            return 1.0
        n, _, m = self.coupling_shape
        a, b = dr.clip(view, 0.0, HIGHEST), dr.clip(sun, 0.0, HIGHEST)
        share = dr.clip((slope + b) / dr.maximum(a + b, 2e-3), 0.0, 1.0)
        x, y, z = dr.sqrt(a / HIGHEST) * (n - 1), dr.sqrt(b / HIGHEST) * (n - 1), share * (m - 1)
        i, j, k = (mi.UInt32(dr.minimum(t, size - 1.001)) for t, size in ((x, n), (y, n), (z, m)))
        f, g, h = x - mi.Float(i), y - mi.Float(j), z - mi.Float(k)

        def along(i: Any, j: Any) -> Any:
            first = (i * n + j) * m + k
            return (1.0 - h) * dr.gather(mi.Float, self.coupling, first) + h * dr.gather(mi.Float, self.coupling, first + 1)

        low, high = (1.0 - g) * along(i, j) + g * along(i, j + 1), (1.0 - g) * along(i + 1, j) + g * along(i + 1, j + 1)
        return dr.select(view < HIGHEST, dr.exp((1.0 - f) * low + f * high), 1.0)

    def _seen_and_lit(self, angle: Any, slopes: tuple[Any, Any], edges: tuple[Any, Any], upright: Any, hidden: Any, high: Any) -> Any:
        """Facets seen and lit over those that stand alone, ``S (1 + Lambda_v)``, of both legs at an ``angle`` of azimuth.

        Either leg alone, the Sun's leg on the viewer's side and independent legs, of which the harmonic mean is taken with the weight of
        Heitz et al. 2014. ``slopes`` and ``edges`` from the facet's tilt towards viewer and Sun, in rms slopes; ``upright``: projection of
        the tilt over the visible area; ``hidden``: Smith's Lambda of the Sun. The Sun's edge is the sheltered one, and
        ``high`` says where nothing hides the Sun.
        """
        dr = self.dr
        seen, lit = self._nested_factor(slopes[0], edges[0]), self._nested_factor(slopes[1], edges[1])
        pair = self._coupling_factor(0.5 * (slopes[0] - slopes[1]), *edges)
        pair = pair * (1.0 + self.shelter.together / (dr.maximum(edges[0], LOWEST) * dr.maximum(edges[1], LOWEST)))
        passage = angle / (4.41 * angle + 1.0) * ((4.41 * math.pi + 1.0) / math.pi)
        one_side = dr.maximum(dr.minimum(seen, lit / dr.maximum(upright * (1.0 + hidden), 1e-12)), 1e-30)
        apart = dr.maximum(dr.minimum(seen * lit * pair / (1.0 + upright * hidden), one_side), 1e-30)
        return dr.select(high, seen, 1.0 / ((1.0 - passage) / one_side + passage / apart))

    def _facet(self, p: Any, view: Any, sun: Any) -> Any:
        """Radiance of the facet at ``p`` for one point of the disc, in local directions to the viewer and the Sun."""
        mi, dr = self.mi, self.dr
        slope_e, slope_n = self._slopes(p.x, p.y)
        ee, en, nn = (float(value) for value in self.roughness.covariance())
        mz = view.z + sun.z
        de, dn = -(view.x + sun.x) / mz, -(view.y + sun.y) / mz
        tan2 = de * de + dn * dn
        de, dn = de - slope_e, dn - slope_n
        determinant = ee * nn - en * en
        exponent = 0.5 * (nn * de * de - 2.0 * en * de * dn + ee * dn * dn) / determinant
        density = dr.exp(-exponent) / (2.0 * math.pi * math.sqrt(determinant))

        def spread(to: Any, part: float = 1.0) -> tuple[Any, Any]:
            """Mean and deviation of the projection of the level patch's slopes on a direction."""
            deviation = part * dr.sqrt(to.x * to.x * ee + 2.0 * to.x * to.y * en + to.y * to.y * nn)
            return to.z - to.x * slope_e - to.y * slope_n, dr.maximum(deviation, 1e-12)

        def area(mean: Any, deviation: Any) -> Any:
            """A+ of a projection."""
            t = mean / deviation
            below = deviation * (1.0 / math.sqrt(2.0 * math.pi)) * dr.exp(-0.5 * t * t)
            return dr.maximum(0.5 * mean * (1.0 + dr.erf(t * math.sqrt(0.5))) + below, 1e-9)

        view_mean, view_deviation = spread(view)
        view_area = area(view_mean, view_deviation)
        sun_mean, sun_deviation = spread(sun, self.in_the_way)
        high = sun_mean >= HIGHEST * sun_deviation
        counts = 1.0 - self.shelter.slack / (1.0 + dr.square(sun_mean / (SLACK_ENDS * sun_deviation)))
        counted = dr.sqrt(counts * dr.square(sun_mean) + dr.square(self.shelter.least * sun_deviation))
        angle = dr.abs(dr.atan2(view.x * sun.y - view.y * sun.x, view.x * sun.x + view.y * sun.y))
        slopes = ((view.x * de + view.y * dn) / view_deviation, (sun.x * de + sun.y * dn) / sun_deviation)
        edges = (view_mean / view_deviation, counted / sun_deviation)
        upright = dr.maximum(view_mean, 0.0) / view_area
        hidden = area(counted, sun_deviation) / dr.maximum(counted, 1e-9) - 1.0
        both = dr.select(sun_mean > 0.0, self._seen_and_lit(angle, slopes, edges, upright, hidden, high), 0.0)
        factor = 0.25 * density * both * (1.0 + tan2) * (1.0 + tan2) / view_area
        cosine = dr.sqrt(dr.maximum(0.5 * (1.0 + dr.dot(view, sun)), 0.0)) * (INCIDENCE_NODES - 1)
        i = mi.UInt32(dr.clip(cosine, 0.0, INCIDENCE_NODES - 1.001))
        f = cosine - mi.Float(i)
        sunlight = (1.0 - f) * dr.gather(mi.Float, self.reflected, i) + f * dr.gather(mi.Float, self.reflected, i + 1)
        return factor * sunlight
