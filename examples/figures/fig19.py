"""Fig. 19: triangles and hexagons on spheres, from a model change of elliptic geometry."""

from functools import partial

import fig17
from figure import run

draw = partial(fig17.draw, geometry="elliptic", radius=1.0, name="Fig. 19")

if __name__ == "__main__":
    run(draw)
