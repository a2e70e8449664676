"""What notebooks show: the numbers, escaped, nothing that runs or loads."""

from __future__ import annotations

import re
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest

import seaglint as sg
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.sun import sun_position
from seaglint.scenario.text.display import compass
from seaglint.store.detection_results import DetectionCase
from seaglint.studies.detect.performance import Performance
from seaglint.studies.detect.study import Study

HOSTILE = "<script>alert(1)</script><img src=x onerror=alert(2)>\"'"


def _harmless(html):
    assert "<script" not in html
    assert "<img" not in html
    assert not re.search(r"<[^>]*\s(on\w+|src|href)\s*=", html)


def test_a_scenario_shows_what_differs_and_its_compass():
    html = parse_scenario({"wind": {"speed_m_s": 9}, "objects": [{"name": "b", "preset": "buoy", "north_m": -900}]})._repr_html_()
    assert "wind.speed_m_s" in html
    assert ">9<" in html
    assert ">7<" in html  # the default
    assert "objects[0].north_m" in html
    assert "from_deg" not in html
    ElementTree.fromstring(html)


def test_hostile_names_stay_text():
    html = parse_scenario({"objects": [{"name": HOSTILE, "preset": "buoy", "north_m": -900}]})._repr_html_()
    _harmless(html)
    assert "&lt;script&gt;" in html


def test_a_scenario_of_likelihood_alone_has_no_sun():
    given = {"likelihood": {"latitudes_deg": [30, 40], "longitudes_deg": [-80, -70]}}
    assert 'class="sun"' not in parse_scenario(given)._repr_html_()


def _marks(raw):
    scenario = parse_scenario(raw)
    return ElementTree.fromstring(compass(scenario, sun_position(scenario)))


def _one(svg, name):
    return next(element for element in svg.iter() if element.get("class") == name)


@pytest.mark.parametrize(("azimuth", "zenith", "x", "y"), [(0, 90, 120, 32), (90, 90, 208, 120), (180, 45, 120, 164), (270, 0, 120, 120)])
def test_the_sun_stands_clockwise_from_north_and_in_the_middle_at_the_zenith(azimuth, zenith, x, y):
    sun = _one(_marks({"sun": {"azimuth_deg": azimuth, "zenith_deg": zenith}}), "sun")
    assert (float(sun.get("cx")), float(sun.get("cy"))) == pytest.approx((x, y), abs=0.1)


def test_the_wind_flies_from_where_it_comes():
    # from the east: it begins at the right of the middle and points to the left
    begin, tip = re.findall(r"[ML]([\d.]+),([\d.]+)", _one(_marks({"wind": {"from_deg": 90}}), "wind").get("d"))[:2]
    assert float(begin[0]) > float(tip[0]) > 120
    assert float(begin[1]) == pytest.approx(120, abs=0.1)


def test_the_view_is_as_wide_as_the_field_of_view():
    path = _one(_marks({"sensor": {"azimuth_deg": 90, "fov_deg": [60, 30], "elevation_deg": -10}}), "view").get("d")
    left, right = re.search(r"L([\d.]+,[\d.]+)A", path)[1], re.search(r"1 ([\d.]+,[\d.]+)Z", path)[1]
    assert left == "196.2,76.0"  # azimuth 60: 120 + 88 sin 60, 120 - 88 cos 60
    assert right == "196.2,164.0"


def test_an_analysis_shows_its_regions():
    frames = np.random.default_rng(1).normal(1.0, 0.1, (4, 24, 24))
    found = sg.analyze(frames, frame_rate=25.0, thresholds=[4.0], filter="none")
    html = found._repr_html_()
    assert f">{found.regions['all'].moments.std:.4g}<" in html
    _harmless(html)


def test_a_study_shows_what_was_varied_and_escapes_it():
    cases = [DetectionCase({"wind.speed_m_s": 5.0}, error=HOSTILE)]
    html = Study(cases, None, False)._repr_html_()
    assert "wind.speed_m_s" in html
    _harmless(html)


def test_what_a_user_gets_of_a_detection_is_shown_too():
    frames = np.random.default_rng(3).normal(10.0, 0.5, (6, 48, 48))
    found = sg.detect(frames, [1.0, 3.0], threshold=3.0, injections=100)
    html = found._repr_html_()
    assert f">{found['sweep'][1]['p_d']:.4g}<" in html
    assert f"false alarms per pixel {found['p_fa']:.4g}" in html
    _harmless(html)


def test_a_detection_shows_each_contrast():
    sweep = [{"contrast": 0.25, "injections": 40, "detected": 31, "p_d": 0.775, "p_d_interval": (0.62, 0.89)}]
    told = {"source": HOSTILE, "sweep": sweep, "detector": "matched", "filter": "none", "threshold_sigma": 3.0}
    found = SimpleNamespace(as_dict=lambda: told | {"p_fa": 0.00135, "p_fa_interval": (0.001, 0.002)}, notes=(HOSTILE,))
    html = Performance._repr_html_(found)
    assert ">0.775<" in html
    assert ">0.62, 0.89<" in html
    _harmless(html)
