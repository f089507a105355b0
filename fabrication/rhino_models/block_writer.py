"""Writes blocks into a Rhino model: one piece of geometry, set into the model many times.

rhino3dm gives definitions random ids; their streams are written here (`ON_InstanceDefinition`,
`opennurbs_instance.cpp`), so that a file of the same panels has the same ids.
"""

import base64
from uuid import UUID

from ...kernel.panels.mould_caps import mould_caps
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_writer import brep_streams
from ..opennurbs.render_meshes import MESH_TOLERANCE, panel_meshes
from ..opennurbs.stream_codes import ANONYMOUS
from ..opennurbs.stream_writer import Chunk, class_object, doubles, encode, ints
from .archive import ObjectAttributes, instance_stream
from .model import RhinoModel, Untyped, add_layer, object_attributes, object_id

_INSTANCE_DEFINITION = UUID("26f8bff6-2618-417f-a158-153d64a94989").bytes_le

_COMPONENT = 0x40008002
"""Type of the chunk that says what a component of a model is called."""

_UNSET_INDEX = -0x7FFFFFFF
_STATIC = 1


def add_definition(
    model: RhinoModel, name: str, definition: UUID, brep: bytes, attributes: ObjectAttributes
) -> None:
    """Add a block of one Brep.

    Parameters
    ----------
    brep : bytes
        The stream of the Brep, in the coordinates of the block.
    attributes : ObjectAttributes
        Those of the Brep.
    """
    model.add("Brep", brep, attributes._replace(is_member=True))
    stream = _definition_stream(name, definition, attributes.id)
    fields: dict[str, Untyped] = model.library.Point(model.library.Point3d(0, 0, 0)).Encode()
    fields["data"] = base64.b64encode(stream).decode("ascii")
    block = model.library.CommonObject.Decode(fields)
    model.file.InstanceDefinitions.AddInstanceDefinition(block)


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
        member = object_attributes(name, "mould member", place)
        add_definition(model, name, block, stream, member)
        blocks.append(block)
    panel_ids: list[int] = found.members.tolist()
    rows: list[int] = found.rows.tolist()
    for i, (panel, row) in enumerate(zip(panel_ids, rows, strict=True)):
        block = blocks[row]
        if block is not None:
            attributes = object_attributes(panels.ids[panel], "mould", place)
            turn, shift = found.rotations[i], found.translations[i]
            model.add("InstanceReference", instance_stream(block, turn, shift), attributes)
    return notes
