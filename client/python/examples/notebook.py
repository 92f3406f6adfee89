"""Steps of a notebook: python3 notebook.py MODEL FOLDER. Compares the highlights and the shape of a model in two views,
and writes pictures and numbers to the folder. Needs an installed sheen, or SHEEN_DAEMON with the path of sheend."""
# %%
import sys
from pathlib import Path

import numpy as np

import sheen

model_file, folder = sys.argv[1], Path(sys.argv[2])
session = sheen.connect()  # $SHEEN_SERVER, else a private daemon
model = session.upload(model_file)
print(model, "box", model.box.tolist())

# %% Zebra stripes. In a notebook the last value of a cell is shown as a picture.
frame = session.render(model, size=(640, 360), planes=("colour", "position", "normal", "curvature", "ptex"),
                       lines="zebra", pattern="stripes:count=30")
frame.save(folder / "zebra.png")

# %% Numbers of the pixels that show the surface.
mean = frame.curvature[frame.hit].mean(axis=1)
print(f"{frame.hit.mean():.1%} of the pixels show the surface; mean curvature "
      f"{np.percentile(mean, 1):.3g} to {np.percentile(mean, 99):.3g} per unit")

# %% The camera goes around the model; the lines stay those of the first camera.
views = [frame.camera.orbit(degrees) for degrees in range(0, 360, 60)]
for i, view in enumerate(session.stream(model, views, size=(320, 180), line_eye=frame.camera.eye)):
    view.save(folder / f"around_{i}.png")

# %%
session.close()
