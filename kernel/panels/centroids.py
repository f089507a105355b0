"""Centres of mass of panels."""

import numpy as np

from ..arrays import FloatArray
from ..spheres.arcs import patch_areas, patch_moments
from .facts import panel_layers
from .panels import Panels


def panel_centroids(panels: Panels) -> FloatArray:
    """Centres of mass (P, 3), in model coordinates; of the surfaces without thickness.

    Notes
    -----
    The moments of the parallel layers between the two faces, in closed form over each layer
    and by Gauss points over the thickness.
    """
    areas, moments = np.zeros((panels.n_panels, 1)), np.zeros((panels.n_panels, 3))
    for weight, rows, arcs in panel_layers(panels):
        areas[:, 0] += weight * patch_areas(rows, arcs, panels.corner_panels)
        moments += weight * patch_moments(rows, arcs, panels.corner_panels)
    return panels.origins + moments / areas
