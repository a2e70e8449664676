"""Densities of draws on a tree of cells, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.climate.draws import Estimate, SamplingPlan, estimate
from seaglint.climate.importance import DensityTree

MIDDLE = 0.37  #: Middle of a ball that no halving of the cube meets.


def away(points):
    return np.sqrt(np.sum((points - MIDDLE) ** 2, axis=1))


def towards(radius, seed, dimensions=3, pilot=4096):
    """Density towards a ball, by levels of its radius."""
    tree = DensityTree.even()
    for turn in range(40):
        drawn = tree.warp(SamplingPlan(1, pilot).uniform(dimensions, seed, purpose=f"pilot {turn}"))
        distance = away(drawn.points)
        # Cells about the ball hold more than the ball: a fiftieth of the draws in it will do.
        level = max(radius, float(np.quantile(distance, 0.08 if turn < 12 else 0.02)))
        tree = tree.refined(drawn, (distance < level).astype(float), 0.3)
        if level == radius:
            return tree.mixed(0.2)
    raise AssertionError


def ball(radius, plan, seed) -> Estimate:
    tree = towards(radius, seed)
    drawn = tree.warp(plan.uniform(3, seed))
    return estimate((away(drawn.points) < radius).astype(float), plan, weight=drawn.weight, heaviest=tree.largest_weight)


def test_an_even_tree_changes_nothing():
    points = SamplingPlan(1, 64).uniform(4, 1)
    drawn = DensityTree.even().warp(points)
    assert np.array_equal(drawn.points, points)
    assert np.all(drawn.weight == 1.0)


def test_points_have_the_density_of_their_weights():
    tree = towards(0.02, 3)
    drawn = tree.warp(np.random.default_rng(5).random((200_000, 3)))
    leaves = np.flatnonzero(tree.axis < 0)
    assert leaves.size > 20
    assert tree.mass[leaves].sum() == pytest.approx(1.0)
    assert tree.volume[leaves].sum() == pytest.approx(1.0)
    # Chi-square of the counts of leaves: its mean is the number of degrees of freedom f, its deviation the root of 2 f; five of them.
    expected = 200_000 * tree.mass[leaves]
    count = np.bincount(drawn.leaf, minlength=tree.axis.size)[leaves]
    assert np.sum((count - expected) ** 2 / expected) < leaves.size + 5.0 * np.sqrt(2.0 * leaves.size)
    # Volumes of cubes by weights, against their edges; 2e5 points of weights up to 5.
    for side in (0.1, 0.5, 0.9):
        inside = np.all(drawn.points < side, axis=1)
        assert np.mean(drawn.weight * inside) == pytest.approx(side**3, abs=5.0 * np.std(drawn.weight * inside) / np.sqrt(200_000))
    assert drawn.weight.max() <= tree.largest_weight <= 5.0 + 1e-9


def test_a_chance_of_a_millionth_has_a_narrow_interval():
    radius = (1e-6 / (4.0 / 3.0 * np.pi)) ** (1.0 / 3.0)
    found = ball(radius, SamplingPlan.of(65_536), 2)
    assert found.low <= 1e-6 <= found.high
    assert found.high / found.low < 1.02


def test_without_hits_the_tree_stays():
    tree = DensityTree.even()
    assert tree.refined(tree.warp(np.full((8, 2), 0.5)), np.zeros(8), 0.3) is tree


def test_unseen_events_can_weigh_as_much_as_the_density_allows():
    plan, tree = SamplingPlan(16, 64), towards(0.1, 1)
    drawn = tree.warp(plan.uniform(3, 1))
    found = estimate(np.zeros(plan.total), plan, weight=drawn.weight, heaviest=tree.largest_weight)
    assert found.value == 0.0
    assert found.high == pytest.approx(3.0 * tree.largest_weight / drawn.weight.sum())


@pytest.mark.validation
@pytest.mark.parametrize(("chance", "points"), [(1e-6, 64), (1e-4, 64), (1e-2, 64), (1e-6, 1024)])
def test_intervals_of_rare_chances_cover_as_they_say(chance, points):
    # 1000 repeats at 95 %: standard error 0.7 %; the bar is 93 to 97 %.
    radius = (chance / (4.0 / 3.0 * np.pi)) ** (1.0 / 3.0)
    found = [ball(radius, SamplingPlan(16, points), seed) for seed in range(1000)]
    assert 930 <= sum(one.low <= chance <= one.high for one in found) <= 970
