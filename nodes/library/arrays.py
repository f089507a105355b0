"""Types of the arrays that go by wire: what each holds, and its shape."""

from typing import Annotated, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray, FloatArray, IntArray
from ..graphs.annotations import ArrayFacts
from ..graphs.ports import Port

_DEGREES = Port(unit="deg")

CreaseAngle: TypeAlias = Annotated[float, Port(unit="deg", min=0, max=180)]

VertexSpheres: TypeAlias = Annotated[FloatArray, ArrayFacts("spheres of vertices", ("V", 5))]
VertexPoints: TypeAlias = Annotated[FloatArray, ArrayFacts("points of vertices", ("V", 3))]
VertexNormals: TypeAlias = Annotated[FloatArray, ArrayFacts("normals of vertices", ("V", 3))]
VertexAxes: TypeAlias = Annotated[FloatArray, ArrayFacts("axes of vertices", ("V", 2, 3))]
VertexDirections: TypeAlias = Annotated[
    FloatArray, ArrayFacts("directions of vertices", ("V", 2, 3))
]
VertexCurvatures: TypeAlias = Annotated[
    FloatArray, ArrayFacts("principal curvatures of vertices", ("V", 2))
]
VertexDistances: TypeAlias = Annotated[FloatArray, ArrayFacts("distances of vertices", ("V",))]
VertexAngles: TypeAlias = Annotated[
    FloatArray, ArrayFacts("angles of vertices", ("V",)), _DEGREES
]
VertexMarks: TypeAlias = Annotated[BoolArray, ArrayFacts("marks of vertices", ("V",))]

EdgeSpheres: TypeAlias = Annotated[FloatArray, ArrayFacts("spheres of edges", ("E", 5))]
EdgeWeights: TypeAlias = Annotated[FloatArray, ArrayFacts("weights of edges", ("E",))]
EdgeAngles: TypeAlias = Annotated[FloatArray, ArrayFacts("angles of edges", ("E",)), _DEGREES]
EdgeDistances: TypeAlias = Annotated[FloatArray, ArrayFacts("distances of edges", ("E",))]

FaceLabels: TypeAlias = Annotated[IntArray, ArrayFacts("labels of faces", ("F",))]
FaceShapes: TypeAlias = Annotated[NDArray[np.str_], ArrayFacts("shapes of faces", ("F",))]
FaceRadii: TypeAlias = Annotated[FloatArray, ArrayFacts("radii of faces", ("F",))]
FaceDistances: TypeAlias = Annotated[FloatArray, ArrayFacts("distances of faces", ("F",))]
FaceMarks: TypeAlias = Annotated[BoolArray, ArrayFacts("marks of faces", ("F",))]
FacePoints: TypeAlias = Annotated[FloatArray, ArrayFacts("points of faces", ("F", 3))]
FaceVectors: TypeAlias = Annotated[FloatArray, ArrayFacts("vectors of faces", ("F", 3))]

PanelLabels: TypeAlias = Annotated[IntArray, ArrayFacts("labels of panels", ("P",))]
MouldRadii: TypeAlias = Annotated[FloatArray, ArrayFacts("radii of moulds", ("k",))]

Points: TypeAlias = Annotated[FloatArray, ArrayFacts("points", ("N", 3))]
Spheres: TypeAlias = Annotated[FloatArray, ArrayFacts("spheres", ("N", 5))]
Numbers: TypeAlias = Annotated[FloatArray, ArrayFacts("numbers", ("N",))]
Angles: TypeAlias = Annotated[FloatArray, ArrayFacts("angles", ("N",)), _DEGREES]
Marks: TypeAlias = Annotated[BoolArray, ArrayFacts("marks", ("N",))]
Names: TypeAlias = Annotated[NDArray[np.str_], ArrayFacts("names", ("N",))]
Vectors: TypeAlias = Annotated[FloatArray, ArrayFacts("vectors", ("N", "n"))]
Quadruples: TypeAlias = Annotated[FloatArray, ArrayFacts("points, four each", ("N", 4, 3))]
Segments: TypeAlias = Annotated[FloatArray, ArrayFacts("ends of segments", ("N", 2, 3))]
SpherePoints: TypeAlias = Annotated[FloatArray, ArrayFacts("points of the 3-sphere", ("N", 4))]
Coordinates: TypeAlias = Annotated[FloatArray, ArrayFacts("coordinates", ("N", 5))]

Vector: TypeAlias = Annotated[FloatArray, ArrayFacts("vector", (3,))]
Matrix: TypeAlias = Annotated[FloatArray, ArrayFacts("matrix", (3, 3))]
Sphere: TypeAlias = Annotated[FloatArray, ArrayFacts("sphere", (5,))]
Transform: TypeAlias = Annotated[FloatArray, ArrayFacts("transform", (5, 5))]
