"""Two bodies close over the glint.

Three instants of `examples/approach.toml`: the viewpoint moves with the defender, and the attacker comes out of the far glint (circles).
"""

import os
import tomllib
from pathlib import Path

import matplotlib.pyplot as plt

import seaglint as sg
from seaglint.studies.sequence.render_sequence import prepare_sequence

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
tables = tomllib.loads(
    (Path(__file__).parents[2] / "examples" / "approach.toml").read_text()
)
tables["sensor"] |= {"pixels": [64, 64] if SMALL else [300, 300]}
if SMALL:
    tables["sea"]["shortest_wave_m"] = 12
run = prepare_sequence(sg.load(tables))
figure, panels = plt.subplots(
    1, 3, figsize=(12, 4.4), sharey=True, layout="constrained"
)
for axes, time in zip(panels, (0, 4, 8), strict=True):
    drawn = run.drawn(time)
    shown = axes.imshow(drawn.layers.radiance, cmap="gray", vmin=0, vmax=25)
    truth = run.objects.truth(
        drawn.sights,
        drawn.sea,
        run.scene_at(time),
        (run.scene.pixels, run.track.at(time).attitude),
    )
    for place in zip(truth["column_px"], truth["row_px"], strict=True):
        axes.plot(*place, "o", ms=12, mfc="none", mec="tab:orange")
    axes.set(title=f"t = {time} s", xlabel="column", ylabel="row")
figure.colorbar(shown, ax=panels, label="radiance, 3.5-5 µm [W m⁻² sr⁻¹]", extend="max")
figure.savefig("approach.png", dpi=100)
