import json

import pytest

from seaglint.studies.article.headline import brightest_point, headline

# Bounds of the rows, from an independent calculation of the article's case (LOWTRAN7 run by run, 50-130 m sensor heights).
BOUNDS = {
    "contrast_mwir": (0.4215, 0.4225),
    "contrast_lwir": (0.1715, 0.1725),
    "blackbody_292_uw_cm2_sr": (140.5, 140.9),
    "calm_peak_apparent_k": (510.0, 560.0),
    "rise_10ms_k": (55.0, 70.0),
    "background_k": (291.4, 293.4),
    "tail_3_sigma": (0.001345, 0.001355),
    "tail_3_5_sigma": (0.0002325, 0.0002335),
    "capillary_length_70ms_cm": (0.2095, 0.2105),
    "capillary_length_300ms_cm": (0.5535, 0.5545),
}


@pytest.fixture(scope="module")
def rows():
    return headline()


@pytest.mark.parametrize("key", BOUNDS)
def test_row_lies_in_its_bounds(rows, key):
    low, high = BOUNDS[key]
    assert low <= rows[key].ours <= high


def test_rows_are_complete_and_fit_for_json(rows):
    assert set(rows) == set(BOUNDS)
    for row in rows.values():
        written = json.loads(json.dumps(row.as_dict(), allow_nan=False))
        assert list(written) == ["article", "ours", "unit", "settings"]


def test_the_brightest_point_sits_where_the_article_says(rows):
    """Sun above the specular direction, and nearer to the sensor for more wind."""
    windy, calm = rows["rise_10ms_k"].settings, rows["calm_peak_apparent_k"].settings
    assert windy["depression_deg"] > calm["depression_deg"]
    assert 90.0 - windy["solar_zenith_deg"] > windy["depression_deg"]
    assert 74.0 <= windy["solar_zenith_deg"] <= 80.0  # 77 in the independent calculation
    assert 1.5 <= windy["depression_deg"] <= 2.5


@pytest.mark.parametrize(("height", "low", "high"), [(100.0, 66.0, 68.0), pytest.param(130.0, 63.0, 65.0, marks=pytest.mark.validation)])
def test_rise_at_two_heights_as_calculated_independently(height, low, high):
    assert low <= brightest_point(10.0, height).rise <= high
