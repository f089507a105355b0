"""Fig. 18: the model change of elliptic geometry carries a plane to two spheres."""

from functools import partial

import fig15
from figure import run

draw = partial(fig15.draw, geometry="elliptic", name="Fig. 18")

if __name__ == "__main__":
    run(draw)
