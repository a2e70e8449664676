"""What a sensor costs: frames behind optics against frames at the aperture, and a frame of 512 x 512 pixels drawn three times finer."""

from __future__ import annotations

import time
from collections.abc import Callable

import numba

from seaglint.scenario.load import parse_scenario
from seaglint.scenario.presets import TABLES, with_sensor
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

PIXELS, FINER = 512, 3
SENSOR = {
    "pixels": [PIXELS, PIXELS],
    "optics": {"focal_length_m": 0.03, "f_number": 2.0, "jitter_urad": 50},
    "detector": {"pitch_um": 15.0, "integration_time_s": 2e-3, "well_capacity_e": 7e6, "read_noise_e": 500, "bit_depth": 14},
    "noise": {"gain_spread": 1e-3, "offset_spread": 200.0, "dead_share": 1e-3},
}


def best(work: Callable[[int], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Shortest time of some calls with growing numbers, by a clock [s]."""
    times = []
    for number in range(5):
        start = clock()
        work(number)
        times.append(clock() - start)
    return min(times[1:])  # the first one compiles


def beside_the_aperture(preset: str, pixels: tuple[int, int], projection: str, elevation_deg: float) -> tuple[int, float, float]:
    """Fine pixels along a pixel, and processor time of a frame at the aperture and of one of counts [s], for a preset's sensor."""
    numba.set_num_threads(1)
    view = {"projection": projection, "azimuth_deg": 180.0, "elevation_deg": elevation_deg}
    tables = with_sensor({"sun": {"zenith_deg": 70.0, "azimuth_deg": 180.0}, "sensor": view}, preset)
    tables["sensor"]["pixels"] = list(pixels)
    scenario = parse_scenario(tables)
    bare = scenario.sensor.model_copy(update=dict.fromkeys(TABLES))
    run, aperture = prepare_sensed(scenario), prepare_sequence(scenario.model_copy(update={"sensor": bare}))
    return run.sensed.oversampling, *(best(work, time.process_time) for work in (lambda k: aperture.at(k / 25.0), run.images))


def measured() -> tuple[float, float, float, float]:
    """Time of a coarse picture, of a finer one, of the focal plane and of the noise [s]."""
    numba.set_num_threads(1)
    run = prepare_sensed(parse_scenario({"sensor": SENSOR, "render": {"oversampling": FINER}}))
    view = list(run.fine_scenario.sensor.fov_deg)
    coarse = prepare_sequence(parse_scenario({"sensor": {"pixels": [PIXELS, PIXELS], "fov_deg": view}}))
    fine = run.fine
    coarse_s, fine_s = best(lambda k: coarse.at(k / 25.0)), best(lambda k: fine.at(k / 25.0))
    picture = fine.at(0.2).radiance
    model = run.sensed.model
    seen = model.focal_plane(picture, FINER)
    plane_s = best(lambda k: model.focal_plane(picture, FINER))
    expose_s = best(lambda k: model.expose(seen, k))
    return coarse_s, fine_s, plane_s, expose_s


def main() -> None:
    """Print the times."""
    for preset in ("mwir-insb-640", "lwir-mct-640"):
        for pixels in ((96, 80), (640, 512)):
            for projection, elevation in (("equal-angle", 0.0), ("equal-angle", -6.0), ("pinhole", 0.0)):
                n, aperture, sensed = beside_the_aperture(preset, pixels, projection, elevation)
                what = f"{preset} {pixels[0]} x {pixels[1]} {projection} {elevation:g} deg, {n} x {n}"
                print(
                    f"{what}: aperture {aperture:.3f} s, sensed {sensed:.3f} s of processor time, {sensed / aperture:.2f} times", flush=True
                )
    coarse_s, fine_s, plane_s, expose_s = measured()
    print(f"{PIXELS} x {PIXELS}: {coarse_s:.3f} s; {FINER} times finer: {fine_s:.3f} s, {fine_s / coarse_s:.2f} times that")
    share = 100 * (plane_s + expose_s) / fine_s
    print(f"optics and detector {plane_s:.3f} s, noise and counts {expose_s:.3f} s: {share:.1f} % of the finer drawing")


if __name__ == "__main__":
    main()
