"""Start and help of the program: a quick start, completion in the shell, lists of formats, and examples.

Quick start: searches of imported libraries for other packages are prevented, and garbage collection is postponed.

Completion: Typer's options for it detect the shell that started the program, which fails within make, tmux and scripts. The options here
take the name of the shell.

Lists of formats in help texts are looked up when a help page is printed, so that no reader of files is imported at the start.

Examples: each command's help ends with lines that work in an empty folder, and also in a folder where other examples were typed before.
Examples that need a scenario or a recording begin with the same two lines, which can be repeated: the scenario is replaced by an equal one,
and ``--resume`` accepts a finished recording. Every other file that an example writes has a different name.
"""

from __future__ import annotations

import atexit
import gc
import sys
from collections.abc import Callable
from contextlib import suppress
from enum import StrEnum
from typing import Annotated, Any, Final

import typer
from typer._completion_classes import completion_init
from typer.completion import install_callback, show_callback
from typer.core import TyperCommand, TyperOption

#: Number of new containers before the first search for unused cycles: the imports of a command make 250,000 to 450,000, nearly all of which
#: stay.
OBJECTS: Final = 600_000


def collect_later() -> None:
    """Postpone the search for unused cycles of objects until after the imports, where hundreds of searches take a tenth of the time.

    The first search restores the previous setting. At the end of the program none is made.
    """
    before = gc.get_threshold()
    if before[0] == OBJECTS:  # postponed already
        return

    def restore(*_: object) -> None:
        gc.callbacks.remove(restore)
        gc.set_threshold(*before)

    gc.callbacks.append(restore)
    gc.set_threshold(OBJECTS, *before[1:])
    # Frozen objects are not searched at the end, where the system takes the memory back anyway.
    atexit.register(gc.freeze)


def only_numpy() -> None:
    """Declare to xarray that all arrays are NumPy's; to find out, it would import Dask and pint where they are installed, 0.4 s.

    The names are xarray's private ones; a version without them imports as before.
    """
    with suppress(ImportError, AttributeError, TypeError):
        from xarray.namedarray import pycompat

        # Modules that are imported already cost nothing, and their arrays have to be recognised.
        names: Any = {"dask", "pint", "sparse", "cupy"} - set(sys.modules)
        for name in names:
            absent = pycompat.DuckArrayModule("seaglint.absent")  # type: ignore[arg-type]
            pycompat._cached_duck_array_modules.setdefault(name, absent)


class Shell(StrEnum):
    """Shells for which words are completed."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"
    POWERSHELL = "powershell"


SHELLS: Final = ", ".join(Shell)


def _install(ctx: typer.Context, param: typer.CallbackParam, shell: Shell | None) -> Any:
    return install_callback(ctx, param, shell)


def _show(ctx: typer.Context, param: typer.CallbackParam, shell: Shell | None) -> Any:
    return show_callback(ctx, param, shell)


InstallCompletion = Annotated[
    Shell | None,
    typer.Option(
        "--install-completion", metavar="SHELL", callback=_install, is_eager=True, help=f"let a shell complete commands: {SHELLS}"
    ),
]
ShowCompletion = Annotated[
    Shell | None,
    typer.Option("--show-completion", metavar="SHELL", callback=_show, is_eager=True, help="print what that would add, and leave"),
]

# Registers the answers to requests that shells send when the tab key is pressed, in Typer's form.
completion_init()


def derived_help(**texts: Callable[[], str]) -> type[TyperCommand]:
    """Return a class of commands that replace ``{NAME}`` in the help of options by ``texts[NAME]()`` when it is printed.

    Command modules are imported to complete words, where no library may be loaded.
    """

    class DerivedHelp(TyperCommand):
        """Command that fills in its help texts."""

        def format_help(self, ctx: Any, formatter: Any) -> None:
            """Write the help page."""
            for option in self.params:
                if isinstance(option, TyperOption) and option.help and "{" in option.help:
                    option.help = option.help.format_map({name: text() for name, text in texts.items()})
            super().format_help(ctx, formatter)

    return DerivedHelp


def listed(words: tuple[str, ...], last: str = "or") -> str:
    """Return words as a list of prose.

    >>> listed((".mp4", ".gif")), listed(("a", "b", "c"), "and"), listed(("a",))
    ('.mp4 or .gif', 'a, b and c', 'a')
    """
    return f"{', '.join(words[:-1])} {last} {words[-1]}" if len(words) > 1 else "".join(words)


# Not my.toml, the name in the guide: a user's own scenario is not to be replaced.
_SCENE = "seaglint init example.toml --overwrite"
_RUN = (_SCENE, "seaglint render example.toml -o example.zarr --frames 0:8 --resume")
# A part of the picture that is stationary, without which the fit is refused.
_FIT = (*_RUN, "seaglint texture fit example.zarr -o model.json \\", "    --region 160:256,160:352 --overwrite")
_ANGLES = "printf 'wavelength_um,wind_speed_m_s,zenith_deg\\n4,5,70\\n' > angles.csv"
_AIR = (
    "printf 'atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,' > air.csv",
    "printf 'solar_zenith_deg,sky_zenith_deg\\n' >> air.csv",
    "printf 'us-standard-1976,7,30,3,75,80\\n' >> air.csv",
)
_VIEWS = (
    "printf 'atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,' > views.csv",
    "printf 'solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad\\n' >> views.csv",
    "printf 'us-standard-1976,7,30,3,75,0,288,0.5\\n' >> views.csv",
)
_LINES = (
    "printf 'kind,atmosphere,wind_speed_m_s,sensor_height_m,elevation_deg,' > lines.csv",
    "printf 'azimuth_from_sun_deg,solar_zenith_deg\\n' >> lines.csv",
    "printf 'path,us-standard-1976,7,30,-1,20,76\\n' >> lines.csv",
)
_BOAT = (
    "printf '[sensor]\\nelevation_deg = -3\\nfov_deg = [4, 2]\\npixels = [128, 64]\\n' > boat.toml",
    'printf \'[[objects]]\\nname = "boat"\\npreset = "small-boat"\\n\' >> boat.toml',
    "printf 'east_m = 0\\nnorth_m = -600\\nheading_deg = 60\\n' >> boat.toml",
)
_RADIOMETER = (
    "printf '[band]\\nmin_um = 8\\nmax_um = 12\\n[sensor]\\nheight_m = 20\\n' > radiometer.toml",
    "printf '# resolution_cm: 20\\nwavelength_um,brightness_temperature_k\\n' > sky.csv",
    "printf '8.5,262\\n8.7,259\\n8.9,257\\n9.1,254\\n' >> sky.csv",
)
_WINDS = (
    *_BOAT,
    "printf 'base = \"boat.toml\"\\n[ensemble]\\nscenes = 4\\nframes = 2\\n' > winds.toml",
    'printf \'[[vary]]\\nkey = "wind.speed_m_s"\\nlaw = "uniform"\\n\' >> winds.toml',
    "printf 'min = 2\\nmax = 12\\n' >> winds.toml",
)
_SHIP = (
    "printf 'date,wind,clouds\\n2026-06-21T12:00,12,3\\n2026-06-21T18:00,9,8\\n' > ship.csv",
    "seaglint weather build ship.csv --utc --map time=date --map wind_speed_m_s=wind:kn \\",
    "    --map cloud_cover=clouds:oktas -o weather.csv",
)

#: Example lines by command. A group of commands has the lines of its first use; the program itself has the empty name.
EXAMPLES: Final[dict[str, tuple[str, ...]]] = {
    "": ("seaglint init my.toml", "seaglint render my.toml -o run.zarr --frames 0:8 --preview", "seaglint info run.zarr"),
    "init": (
        "seaglint init calm.toml --preset calm",
        "seaglint init uncooled.toml --camera pitch_um=17,pixels=640x512,focal_length_mm=35,f_number=1.1,netd_mk=50,band_um=7.5-13.5",
    ),
    "schema": ("seaglint schema > scenario.schema.json",),
    "doctor": ("seaglint doctor --json", "seaglint doctor --compile"),
    "view": (*_RUN, "seaglint view example.zarr"),
    "info": (*_RUN, "seaglint info example.zarr"),
    "reproduce": ("seaglint reproduce headline",),
    "reproduce headline": ("seaglint reproduce headline",),
    **{f"reproduce {name}": (f"seaglint reproduce {name} -o article",) for name in ("fig2", "fig3", "fig4", "fig5", "fig10", "table1")},
    "reproduce fig12": ("seaglint reproduce fig12 --frames 60:80 --pixels 128 -o article",),
    "compare": (*_RADIOMETER, "seaglint compare sky.csv radiometer.toml --zenith-deg 30 -o sky.png --overwrite"),
    "reproduce measured": ("seaglint reproduce measured -o measured --overwrite",),
    "mean": (_SCENE, "seaglint mean example.toml -o mean.nc --preview"),
    "render": (_SCENE, "seaglint render example.toml -o example.zarr --frames 0:8 --preview --resume"),
    "sense": (
        "printf '[band]\\nmin_um = 3.0\\nmax_um = 5.0\\n' > camera.toml",
        "seaglint render camera.toml -o aperture.zarr --frames 0:4 --resume",
        "seaglint sense aperture.zarr camera.toml --sensor mwir-insb-640 --oversampling 1 -o counts.zarr",
    ),
    "sensor": (_SCENE, "seaglint sensor example.toml --sensor mwir-insb-640"),
    "sweep": (
        _SCENE,
        "seaglint sweep example.toml --vary wind.speed_m_s=2:10:4 --vary sun.zenith_deg=20,60 \\",
        "    --at view_zenith_deg=0:80:20 -o sweep.nc --preview",
    ),
    "evaluate": (_ANGLES, "seaglint evaluate emissivity angles.csv -o angles-out.csv"),
    "evaluate atmosphere": (*_AIR, "seaglint evaluate atmosphere air.csv --band 3.5-5.0 -o air-out.csv"),
    "evaluate emissivity": (_ANGLES, "seaglint evaluate emissivity angles.csv -o emissivity.csv"),
    "evaluate mean": (*_VIEWS, "seaglint evaluate mean views.csv --band 3.5-5.0 -o views-out.csv"),
    "evaluate slopes": (_SCENE, "seaglint evaluate slopes example.toml --bands 5,20,100,1000"),
    "evaluate scattered": (*_LINES, "seaglint evaluate scattered lines.csv --band 3.5-5.0 -o lines-out.csv"),
    "atmosphere": (_SCENE, "seaglint atmosphere export example.toml -o atmosphere.nc"),
    "atmosphere export": (_SCENE, "seaglint atmosphere export example.toml -o air.nc"),
    "atmosphere write": (_SCENE, "seaglint atmosphere write example.toml --format tape5 -o decks"),
    "atmosphere info": ("seaglint atmosphere info midlatitude-summer --plot air.png",),
    "atmosphere path": (
        _SCENE,
        "seaglint atmosphere path example.toml --range-m 1000,5000,10000 --target-height-m 0,10",
        "seaglint atmosphere path --temperature-k 300 --pressure-hpa 1013 --vapour-pressure-hpa 26 --length-km 5 --band-um 3.7-4.2 "
        "--co2-ppmv 425",
    ),
    "atmosphere sky": (_SCENE, "seaglint atmosphere sky example.toml --zenith-deg 0,30,60,80,89"),
    "atmosphere read": (
        _SCENE,
        "seaglint atmosphere write example.toml --format tape5 -o modtran",
        "# run your MODTRAN in the folder modtran",
        "seaglint atmosphere read modtran -o modtran.nc",
    ),
    "weather": ("seaglint weather info north-atlantic",),
    "weather build": _SHIP,
    "weather info": ("seaglint weather info north-atlantic",),
    "texture": (*_RUN, "seaglint texture fit example.zarr -o texture.json --region 160:256,160:352"),
    "texture fit": _FIT,
    "texture sample": (*_FIT, "seaglint texture sample model.json -o loop.zarr --size 256x256 --frames 32"),
    "texture compare": (*_FIT, "seaglint texture compare example.zarr model.json --region 160:256,160:352"),
    "texture place": (*_FIT, "seaglint texture place model.json example.toml -o placed.zarr"),
    "ensemble": (*_WINDS, "seaglint ensemble winds.toml -o scenes --draw-only"),
    "analyze": (*_RUN, "seaglint analyze example.zarr --report clutter.html"),
    "detect": (*_RUN, "seaglint detect recording example.zarr -o found"),
    "detect recording": (*_RUN, "seaglint detect recording example.zarr --contrast 5:40:5 --report detected.html"),
    "detect scene": (*_BOAT, "seaglint detect scene boat.toml --detector matched --frames 4 -o seas"),
    "detect design": (*_BOAT, "seaglint detect design boat.toml --p-fa 3e-3 --frames 4 -o need"),
    "detect range": (
        *_BOAT,
        "seaglint detect range boat.toml --bearings 90 --p-fa 3e-3 --precision 0.2 \\",
        "    --frames 4 --injections 50 -o far",
    ),
    "likelihood": (
        "printf '[likelihood]\\nthreshold_w_m2_sr = [0.25, 2.5]\\n' > looks.toml",
        "seaglint likelihood looks.toml -o likelihood",
    ),
    "export": (*_RUN, "seaglint export example.zarr -o example.tif"),
    "export-sea": (_SCENE, "seaglint export-sea example.toml -o sea.nc"),
    "labels": (*_BOAT, "seaglint render boat.toml -o boat.zarr --frames 0:2 --resume", "seaglint labels boat.zarr -o labels.json"),
    "dataset": (*_WINDS, "seaglint dataset winds.toml -o data --format coco"),
}


def epilog(command: str) -> str | None:
    """Return the example at the end of a command's help; None for a command without example."""
    lines = EXAMPLES.get(command)
    # Click does not wrap a paragraph that begins with \b.
    return None if lines is None else "\b\n" + "\n".join(["Example:", *(f"  {line}" for line in lines)])


def add_examples(app: typer.Typer, before: str = "") -> None:
    """End the help of a group, and of each command in it, with its example."""
    app.info.epilog = epilog(before.strip())
    for info in app.registered_commands:
        callback = info.callback.__name__ if info.callback is not None else ""
        info.epilog = epilog(before + (info.name or callback.replace("_", "-")))
    for group in app.registered_groups:
        if group.typer_instance is not None:
            add_examples(group.typer_instance, f"{before}{group.name} ")
