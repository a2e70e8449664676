"""Functions of ``import seaglint as sg``: from a scenario file to labelled images and their clutter.

.. code-block:: python

    import seaglint as sg

    scene = sg.load("my.toml")
    mean = sg.mean(scene)  # xarray.Dataset: radiance and its parts
    run = sg.render(scene, "run.zarr")  # xarray.Dataset: radiance over time, y, x
    kelvin = sg.apparent_temperature(run.radiance.isel(time=0))
    print(sg.analyze(run).as_dict()["regions"]["glint"]["std"])

Each is a few lines over the rooms below, which have more to choose: :mod:`seaglint.scenario`, :mod:`seaglint.studies`,
:mod:`seaglint.analysis`.
"""

from seaglint.api.comparing import compare_spectrum
from seaglint.api.judging import detect
from seaglint.api.laboratory import homogeneous_path
from seaglint.api.many import dataset, ensemble
from seaglint.api.runs import export, render, sense, sensor
from seaglint.api.scenes import image, load, mean
from seaglint.api.statistics import analyze, apparent_temperature
from seaglint.api.sweeps import sweep

__all__ = [
    "analyze",
    "apparent_temperature",
    "compare_spectrum",
    "dataset",
    "detect",
    "ensemble",
    "export",
    "homogeneous_path",
    "image",
    "load",
    "mean",
    "render",
    "sense",
    "sensor",
    "sweep",
]
