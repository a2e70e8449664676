"""Functions of ``import seaglint as sg``: each command of the program as a function, from a scenario file to labelled images.

.. code-block:: python

    import seaglint as sg

    scene = sg.load("my.toml")
    mean = sg.mean(scene)  # xarray.Dataset: radiance and its parts
    run = sg.render(scene, "run.zarr")  # xarray.Dataset: radiance over time, y, x
    kelvin = sg.apparent_temperature(run.radiance.isel(time=0))
    print(sg.analyze(run).as_dict()["regions"]["glint"]["std"])

A command has the function of its name: ``seaglint export-sea`` is :func:`export_sea`, ``seaglint detect range`` is :func:`detect_range`.
Commands of a group are functions of a module: ``seaglint texture fit`` is :func:`sg.texture.fit`. The
other modules are ``sg.atmosphere``, ``sg.evaluate``, ``sg.reproduce`` and ``sg.weather``. Options of the terminal have no parameters:
results are returned, not printed. Results with axes are xarray; other results are a
:class:`~seaglint.api.inputs_and_results.ResultRecord` with ``as_dict()`` and ``plot()``.

Where a function takes a scenario, it takes a file's name, tables in a mapping, or the result of :func:`load`.
"""

from seaglint.api import air_functions as atmosphere
from seaglint.api import article_results as reproduce
from seaglint.api import case_tables as evaluate
from seaglint.api import texture_models as texture
from seaglint.api import weather_tables as weather
from seaglint.api.detectors import detect, detect_design, detect_range, detect_recording, detect_scene
from seaglint.api.exports import export, export_sea, labels
from seaglint.api.measurements import analyze, apparent_temperature, compare, compare_spectrum, homogeneous_path
from seaglint.api.scenario_functions import image, info, init, likelihood, load, mean, schema, sweep
from seaglint.api.sequences import dataset, ensemble, frames, render, sense, sensor

__all__ = [
    "analyze",
    "apparent_temperature",
    "atmosphere",
    "compare",
    "compare_spectrum",
    "dataset",
    "detect",
    "detect_design",
    "detect_range",
    "detect_recording",
    "detect_scene",
    "ensemble",
    "evaluate",
    "export",
    "export_sea",
    "frames",
    "homogeneous_path",
    "image",
    "info",
    "init",
    "labels",
    "likelihood",
    "load",
    "mean",
    "render",
    "reproduce",
    "schema",
    "sense",
    "sensor",
    "sweep",
    "texture",
    "weather",
]
