"""Writes blocks into a Rhino model: one piece of geometry, set into the model many times.

rhino3dm gives definitions random ids; their streams are written here (`ON_InstanceDefinition`,
`opennurbs_instance.cpp`), so that a file of the same panels has the same ids.
"""

from uuid import UUID

from ...kernel.arrays import FloatArray
from ...kernel.panels.mould_caps import mould_caps
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_writer import brep_streams
from ..opennurbs.render_meshes import MESH_TOLERANCE, panel_meshes
from ..opennurbs.stream_codes import ANONYMOUS
from ..opennurbs.stream_writer import Chunk, class_object, doubles, encode, ints
from .model import RhinoModel, Untyped, add_layer, object_attributes, object_id

_INSTANCE_DEFINITION = UUID("26f8bff6-2618-417f-a158-153d64a94989").bytes_le

_COMPONENT = 0x40008002
"""Type of the chunk that says what a component of a model is called."""

_UNSET_INDEX = -0x7FFFFFFF
_STATIC = 1


def add_definition(
    model: RhinoModel, name: str, definition: UUID, geometry: Untyped, attributes: Untyped
) -> None:
    """Add a block of one object.

    Parameters
    ----------
    geometry : CommonObject
        The object, in the coordinates of the block.
    attributes : ObjectAttributes
        With an id.
    """
    attributes.Mode = model.library.ObjectMode.InstanceDefinitionObject
    model.file.Objects.Add(geometry, attributes)
    stream = _definition_stream(name, definition, attributes.Id)
    model.file.InstanceDefinitions.AddInstanceDefinition(model.decode(stream))


def _definition_stream(name: str, definition: UUID, member: UUID) -> bytes:
    """A block of one object as an `ON_InstanceDefinition`."""
    text = (name + "\0").encode("utf-16-le")
    component = Chunk(_COMPONENT, (
        ints(1, 0) + b"\0\1" + definition.bytes_le + b"\0\1" + ints(_UNSET_INDEX) + b"\1",
        ints(len(text) // 2) + text,
    ))  # fmt: skip
    no_units = Chunk(ANONYMOUS, (ints(1, 0), ints(0), doubles(1), ints(0)))
    box = doubles(1, 0, 0, -1, 0, 0)
    members = b"\1" + ints(1) + member.bytes_le + b"\0"
    # Three texts are empty: description, link, and label of the link.
    body = Chunk(
        ANONYMOUS, (ints(1, 0), component, ints(_STATIC), no_units, bytes(12), box, members)
    )
    return encode(class_object(_INSTANCE_DEFINITION, body))


def add_instance(
    model: RhinoModel,
    definition: UUID,
    rotation: FloatArray,
    translation: FloatArray,
    attributes: Untyped,
) -> None:
    """Set a block into the model.

    Parameters
    ----------
    definition : UUID
        Id of the block.
    rotation : (3, 3) float array
        How the block is turned.
    translation : (3,) float array
        Where its origin goes.
    """
    transform = model.library.Transform(1.0)
    for i in range(3):
        for j in range(3):
            setattr(transform, f"M{i}{j}", float(rotation[i, j]))
        setattr(transform, f"M{i}3", float(translation[i]))
    reference = model.library.InstanceReference(definition, transform)
    model.file.Objects.Add(reference, attributes)


def add_mould_blocks(model: RhinoModel, panels: Panels, *, render_meshes: bool) -> list[str]:
    """Add a block for every mould, and set it under each of its panels.

    Parameters
    ----------
    panels : Panels
        With and without moulds.
    render_meshes : bool
        Whether the blocks carry triangles for viewers that cannot mesh them.

    Returns
    -------
    list of str
        Moulds that are left out, with their reasons.
    """
    # They lie under the panels: they are there to be switched on.
    place = add_layer(model, "Moulds", UNLABELLED, has_material=True, visible=False)
    found = mould_caps(panels)
    meshes = panel_meshes(found.caps, MESH_TOLERANCE) if render_meshes else None
    streams = brep_streams(found.caps, meshes)
    judged = verify_breps(streams, found.caps.spheres, found.caps.origins)
    notes: list[str] = []
    blocks: list[UUID | None] = []
    for name, stream, errors in zip(found.caps.ids, streams, judged, strict=True):
        if errors.reason():
            notes.append(f"the block of {name} is left out: {errors.reason()}")
            blocks.append(None)
            continue
        block = object_id(name, "mould block")
        member = object_attributes(model, name, "mould member", place)
        add_definition(model, name, block, model.decode(stream), member)
        blocks.append(block)
    panel_ids: list[int] = found.members.tolist()
    rows: list[int] = found.rows.tolist()
    for i, (panel, row) in enumerate(zip(panel_ids, rows, strict=True)):
        block = blocks[row]
        if block is not None:
            attributes = object_attributes(model, panels.ids[panel], "mould", place)
            turn, shift = found.rotations[i], found.translations[i]
            add_instance(model, block, turn, shift, attributes)
    return notes
