"""What tests of mesh files share: reading what a text says, and its errors."""

from collections.abc import Callable
from pathlib import Path

import pytest

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.reader import read_content, read_mesh
from spheremesh.fabrication.polygons import FileContent
from spheremesh.kernel.errors import InputError


@pytest.fixture(scope="session")
def quad_and_triangle() -> Mesh:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 1 / 3], [2, 0.5, 0]]
    return Mesh(points, [[1, 4, 2], [0, 1, 2, 3]])


@pytest.fixture(scope="session")
def faces_of() -> Callable[[Mesh], list[list[int]]]:
    return lambda mesh: [face.tolist() for face in mesh.faces]


@pytest.fixture(scope="session")
def corners_of() -> Callable[[Mesh], list[list[list[float]]]]:
    return lambda mesh: [mesh.vertices[face].tolist() for face in mesh.faces]


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Mesh]:
    """Read a file of that name and content."""

    def write_and_read(name: str, content: str | bytes, layer: str = "") -> Mesh:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_mesh(path, layer)

    return write_and_read


@pytest.fixture
def content(tmp_path: Path) -> Callable[..., FileContent]:
    """What a file of that name holds, with remarks."""

    def write_and_read(name: str, data: str | bytes, layer: str = "") -> FileContent:
        path = tmp_path / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return read_content(path, layer)

    return write_and_read


@pytest.fixture
def error_of(tmp_path: Path) -> Callable[..., str]:
    """Message of the error at a file of that name and content."""

    def write_and_fail(name: str, content: str | bytes | None = None, layer: str = "") -> str:
        path = tmp_path / name
        if content is not None:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(InputError) as caught:
            read_mesh(path, layer)
        message = str(caught.value)
        assert "\n" not in message
        assert message.startswith(f"cannot read {path}: ")
        return message

    return write_and_fail
