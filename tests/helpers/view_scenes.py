"""Cameras in any attitude over a sea with a warm sky, shared by the tests of views."""

from __future__ import annotations

import numpy as np
from render_scenes import sea_view, turned_scene

from seaglint.facet.legs import Shadowing
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic

WIND = 5.0
COARSE = np.arange(1990.0, 2900.0, 60.0)
SLOPES = cox_munk_anisotropic(WIND, np.radians(30.0))


def attitude(azimuth, elevation, roll=0.0):
    return Attitude(*(float(np.radians(a)) for a in (azimuth, elevation, roll)))


def imager(projection="pinhole", width=12.0, height=9.0, columns=32, rows=24):
    return Imager(projection, float(np.radians(width)), float(np.radians(height)), columns, rows)


def prepared_view(air, eye, pointing, waves=None, *, height=30.0, sun=(60.0, 0.0), place=(0.0, 0.0), **options):
    still = Track.standing(height, pointing)
    track = Track(still.time, still.values + np.array([*place, 0.0, 0.0, 0.0, 0.0]))
    return turned_scene(lambda h: sea_view(air, SLOPES, h, *sun, shadowing=Shadowing(bands=1)), eye, track, waves, **options)


def likeness(one, other):
    return np.corrcoef(one.ravel(), other.ravel())[0, 1]


def moving(air, waves, **options):
    columns = {"time": [0.0, 1.0], "east": [0.0, 20.0], "north": [0.0, 5.0], "height": [30.0, 31.5], "azimuth": np.radians([350.0, 20.0])}
    columns |= {"elevation": np.radians([-8.0, -6.0]), "roll": np.radians([10.0, -10.0])}
    track = Track.create({name: np.asarray(values) for name, values in columns.items()}, ["a", "b"])
    return turned_scene(
        lambda h: sea_view(air, SLOPES, h, shadowing=Shadowing(bands=1)), imager(columns=24, rows=18), track, waves, **options
    )
