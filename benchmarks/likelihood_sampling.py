"""Measure the draws of likelihoods: coverage of their intervals, and their variance against plain random draws.

Usage: ``python benchmarks/likelihood_sampling.py coverage|efficiency|million [--seeds N]``; the tables are those of
docs/validation/likelihood.md. The chance that intervals should contain is the mean of all seeds.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.draws import Estimate, estimate
from seaglint.scenario.load import parse_scenario
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import Draws, aimed, draw, draw_values

REGION = {"latitudes_deg": [35, 65], "longitudes_deg": [-70, 0]}
TOWARDS = {"azimuth_from_sun_deg": [-15, 15]}
PLACE = {"place": {"latitude_deg": 45, "longitude_deg": -30}}
SUN = {"sun": {"zenith_deg": 75.0, "azimuth_deg": 200.0}}

#: Tables beside ``[likelihood]``, and keys in it, by kind of scenario.
KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "one Sun": (SUN, {}),
    "one Sun, within 15 deg": (SUN, TOWARDS),
    "place": (PLACE, {}),
    "region": ({}, REGION),
    "region, within 15 deg": ({}, REGION | TOWARDS),
}

#: Kind, case, azimuths, threshold [W m-2 sr-1] and draws of the table of coverage.
COVERED = (
    ("one Sun, within 15 deg", "single-look", "drawn", 0.25, 1024),
    ("one Sun, within 15 deg", "single-look", "integrated", 0.25, 1024),
    ("region, within 15 deg", "single-look", "integrated", 0.25, 1024),
    ("place", "single-look", "integrated", 0.25, 1024),
    ("place", "single-look", "drawn", 2.5, 1024),
    ("place", "trajectory", "drawn", 0.25, 1024),
    ("place", "single-look", "integrated", 120.0, 1024),
    ("place", "single-look", "drawn", 120.0, 1024),
    ("region", "field-of-view", "drawn", 2.5, 1024),
    ("place", "single-look", "integrated", 0.25, 8192),
    ("place", "single-look", "drawn", 2.5, 8192),
    ("place", "trajectory", "drawn", 30.0, 1024),
    ("place", "single-look", "drawn", 2.5, 65_536),
    ("place", "single-look", "drawn", 200.0, 65_536),
)


def model(kind: str, case: str, thresholds: tuple[float, ...], azimuths: str = "auto") -> LikelihoodModel:
    """Return the model of a scenario, with its tables of air and sea."""
    tables, keys = KINDS[kind]
    wanted = {"threshold_w_m2_sr": list(thresholds), "case": case, **({"azimuths": azimuths} if case == "single-look" else {}), **keys}
    made = LikelihoodModel.of(parse_scenario(tables | {"band": {"min_um": 3.0, "max_um": 5.0}, "likelihood": wanted}))
    _ = made.light, made.seas, made.sun or made.ephemeris
    return made


def estimated(made: LikelihoodModel, samples: int, seed: int) -> tuple[Draws, Estimate]:
    """Return the draws of a seed and the estimate of the first threshold."""
    drawn = draw(made, samples=samples, seed=seed, aim=aimed(made, samples=samples, seed=seed))
    values = draw_values(made, drawn, made.settings.threshold_w_m2_sr[0])
    return drawn, estimate(values, drawn.plan, weight=drawn.weight, heaviest=drawn.heaviest)


def coverage(seeds: int, rows: tuple[int, ...]) -> None:
    """Print the share of seeds whose interval contains the mean of all seeds."""
    print(
        "| case | azimuths | W m-2 sr-1 | draws | chance | inside [%] | too low, too high [%] | upper over lower, median, 95 % of seeds |"
    )
    for row in rows or range(len(COVERED)):
        kind, case, azimuths, threshold, samples = COVERED[row]
        made = model(kind, case, (threshold,), azimuths)
        found, aims = [], 0
        for seed in range(seeds):
            drawn, one = estimated(made, samples, seed)
            aims += drawn.aim is not None
            found.append((one.value, one.low, one.high))
        value, low, high = np.array(found).T
        chance = value.mean()
        ratio = np.quantile(high / np.maximum(low, 1e-300), [0.5, 0.95])
        error = 100 * value.std() / chance / seeds**0.5
        inside, below, above = 100 * np.mean((low <= chance) & (chance <= high)), 100 * np.mean(high < chance), 100 * np.mean(low > chance)
        print(
            f"| {case}, {kind} | {azimuths} | {threshold:g} | {samples} | {chance:.3g} +- {error:.1f} % | "
            f"{inside:.1f} | {below:.1f}, {above:.1f} | {ratio[0]:.3g}, {ratio[1]:.3g} | {seeds} seeds, {aims} aimed",
            flush=True,
        )


def _variance(made: LikelihoodModel, drawn: Draws, threshold: float) -> float:
    """Return the variance of a draw between the means of scramblings."""
    shape = (drawn.plan.scramblings, drawn.plan.points)
    means = np.average(draw_values(made, drawn, threshold).reshape(shape), axis=1, weights=drawn.weight.reshape(shape))
    return float(np.var(means, ddof=1)) * drawn.plan.points


def efficiency(seeds: int, samples: int = 65_536) -> None:
    """Print the variance of plain draws over that of even Sobol points, and of draws towards glint, by draws and by processor time."""
    print("| case | W m-2 sr-1 | even points | towards glint, by draws | by processor time |")
    for case in ("trajectory", "field-of-view"):
        for kind in KINDS:
            made = model(kind, case, (0.25, 2.5))
            plain, seconds = _timed(lambda made=made: [draw(made, samples=samples, seed=10**6, plain=True)])
            even = [draw(made, samples=samples, seed=seed) for seed in range(seeds)]
            ours, own = _timed(
                lambda made=made: [draw(made, samples=samples, seed=s, aim=aimed(made, samples=samples, seed=s)) for s in range(seeds)]
            )
            cost = own / seeds / seconds
            for threshold in (0.25, 2.5):
                values = draw_values(made, plain[0], threshold)
                mean = np.average(values, weights=plain[0].weight)
                alone = float(np.mean((plain[0].weight * (values - mean)) ** 2))
                points, towards = (alone / np.mean([_variance(made, d, threshold) for d in every]) for every in (even, ours))
                more = np.mean([1.0 + (0 if d.aim is None else d.aim.draws) / samples for d in ours])
                print(
                    f"| {case}, {kind} | {threshold:g} | {points:.1f} | {towards / more:.1f} | {towards / cost:.1f} | P {mean:.3g}",
                    flush=True,
                )


def _timed(work: Any) -> tuple[list[Draws], float]:
    start = time.process_time()
    return work(), time.process_time() - start


def million(seeds: int) -> None:
    """Print the intervals of a chance near 1e-6 by a million draws."""
    for kind, case, threshold in (("place", "single-look", 180.0), ("region", "single-look", 200.0), ("region", "trajectory", 400.0)):
        made = model(kind, case, (threshold,))
        found: list[FloatArray] = []
        for seed in range(seeds):
            one = estimated(made, 2**20, seed)[1]
            found.append(np.array([one.value, one.low, one.high]))
        value, low, high = np.array(found).T
        print(f"{case}, {kind}, {threshold:g}: {value.mean():.3g}, upper over lower {np.quantile(high / low, [0.5, 0.95])}, {seeds} seeds")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", choices=("coverage", "efficiency", "million"))
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--rows", type=int, nargs="*", default=[], help="rows of the table of coverage; all")
    given = parser.parse_args()
    if given.table == "coverage":
        coverage(given.seeds, tuple(given.rows))
    else:
        {"efficiency": efficiency, "million": million}[given.table](given.seeds)
