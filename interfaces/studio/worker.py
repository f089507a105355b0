"""The process that runs graphs: warm, and gone at once when it is killed.

It is told by a connection what to run, and tells by the same what happens. The library is
imported before anything is asked; results stand in the store, which outlives it.
"""

import os
import tempfile
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from queue import Empty, Queue
from threading import Event as Flag
from threading import Thread
from typing import Any, TypeAlias

import xxhash

from ...fabrication.output_folder import output_folder
from ...kernel.errors import SpheremeshError
from ...nodes.graphs.errors import GraphError, NodeError
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.node import NodeWarning, load_library
from ...nodes.graphs.running.events import Event, RunCancelledError
from ...nodes.graphs.specification.specification import Specification, frozen
from ...nodes.graphs.specification.wires import Step, Wire
from ...nodes.graphs.stores.disk import DiskStore
from ...nodes.graphs.stores.entries import Store
from ...nodes.graphs.stores.memory import MemoryStore
from ..hops.guard import check_graph_files
from .previews import carrier_types, has_kind, preview_node

Told: TypeAlias = dict[str, Any]
Tell: TypeAlias = Callable[[Told], None]

PREVIEW = "preview_"
"""How the steps begin that make previews; no step of a user is called so."""
MOST_CARRIERS = 3


@dataclass(frozen=True)
class Place:
    """Where a worker works.

    Attributes
    ----------
    cache : str
        Folder of results; empty for none on disk.
    files : str
        Folder that steps may read from and write to.
    modules : tuple of str
        Of own nodes.
    """

    cache: str
    files: str
    modules: tuple[str, ...] = ()


def work(line: Connection, place: Place) -> None:
    """Run what the line asks for until it is closed."""
    warnings.simplefilter("ignore")
    load_library()
    for module in place.modules:
        import_module(module)
    store: Store = DiskStore(place.cache) if place.cache else MemoryStore()
    asked: Queue[Told | None] = Queue()
    cancel = Flag()
    Thread(target=_listen, args=(line, asked, cancel), daemon=True).start()
    with tempfile.TemporaryDirectory(prefix="spheremesh-") as scratch:
        line.send({"type": "ready"})
        while (order := _latest(asked, cancel)) is not None:
            _answer(order, Context(store, Path(place.files), Path(scratch), cancel, line.send))


def _listen(line: Connection, asked: "Queue[Told | None]", cancel: Flag) -> None:
    while True:
        try:
            order = line.recv()
        except (EOFError, OSError):
            os._exit(0)  # whoever asked has gone
        # What runs is called off before what comes next can begin.
        cancel.set()
        asked.put(order)


def _latest(asked: "Queue[Told | None]", cancel: Flag) -> Told | None:
    """The last of the orders that wait: what came before is out of date."""
    order = asked.get()
    while True:
        try:
            order = asked.get_nowait()
        except Empty:
            cancel.clear()
            return order


@dataclass(frozen=True)
class Context:
    """What runs of a worker have in common."""

    store: Store
    files: Path
    scratch: Path
    cancel: Flag
    tell: Tell


def _answer(order: Told, context: Context) -> None:
    began, cpu = time.perf_counter(), time.process_time()
    state, text = "done", ""
    try:
        graph = Graph.from_json(order["graph"], cache=context.store, unfinished=True)
        if order.get("folder"):
            text = _export(graph, order, context)
        else:
            state = _show(graph, order, context)
    except RunCancelledError:
        state = "cancelled"
    except (GraphError, NodeError, SpheremeshError, OSError) as error:
        state, text = "failed", str(error)
    except Exception as error:  # noqa: BLE001 - a fault of ours is told, and nothing ends by it
        state, text = "failed", f"{type(error).__name__}: {error}"
    context.tell({
        "type": "run", "run": order["run"], "rev": order["rev"], "state": state, "text": text,
        "seconds": time.perf_counter() - began, "cpu": time.process_time() - cpu,
    })  # fmt: skip


def _show(graph: Graph, order: Told, context: Context) -> str:
    """Run targets one by one and tell their previews; a fault of one is none of the others."""
    state = "done"
    for target in order["targets"]:
        try:
            _show_one(graph, target, order, context)
        except RunCancelledError:
            raise
        except (GraphError, NodeError, SpheremeshError, OSError, ValueError) as error:
            state = "failed"
            step = getattr(error, "step", "") or target.partition(".")[0]
            reason = error.reason if isinstance(error, NodeError) else str(error)
            if step.startswith(PREVIEW):
                step, reason = target.partition(".")[0], f"cannot be shown: {reason}"
            context.tell(
                _said(order, {"type": "fault", "target": target, "step": step, "text": reason})
            )
    return state


def _said(order: Told, told: Told) -> Told:
    return {"run": order["run"], "rev": order["rev"], **told}


def _show_one(graph: Graph, target: str, order: Told, context: Context) -> None:
    wire = graph.wire(target)
    if isinstance(wire, Step):
        wire = wire.wires[0]
    check_graph_files(_needed(graph.specification, wire.step), context.files)
    carriers = _carriers(graph, wire)
    copy = graph.copy()
    name = f"{PREVIEW}{wire.step.name}_{wire.port.name}"
    inputs = {f"on_{i}": each for i, each in enumerate(carriers)}
    written = context.scratch if wire.step.node.is_writer else None
    copy.add(preview_node(wire.port, len(carriers), written), name, value=wire, **inputs)

    def _note(event: Event) -> None:
        if not event.step.startswith(PREVIEW):
            context.tell(_said(order, {"type": "step", **_event(event)}))

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NodeWarning)
            array = copy.run(
                name, on_event=_note, cancel=context.cancel, read_from=context.files,
                write_to=context.scratch,
            )  # fmt: skip
    finally:
        _tell_messages(copy, [wire.step], order, context)
    data = array.tobytes()
    digest = xxhash.xxh3_128_hexdigest(data)
    context.tell(
        _said(order, {"type": "preview", "target": target, "digest": digest, "data": data})
    )


def _tell_messages(
    graph: Graph, targets: Sequence[Step], order: Told, context: Context
) -> None:
    """Tell what each step that was needed warns about, kept or made; an empty list for none."""
    steps = {name for each in targets for name in _needed(graph.specification, each).steps}
    said: dict[str, list[str]] = {name: [] for name in sorted(steps)}
    for name, texts in graph.messages.items():
        outer, _, inner = name.partition("/")
        if outer in said:
            said[outer] += [f"{inner}: {text}" if inner else text for text in texts]
    context.tell(_said(order, {"type": "messages", "messages": said}))


def _event(event: Event) -> Told:
    return {
        "step": event.step, "state": event.state, "seconds": event.seconds,
        "share": event.share, "text": event.text,
    }  # fmt: skip


def _needed(graph: Specification, step: Step) -> Specification:
    """A graph with the steps alone that one of them needs."""
    names, pending = set[str](), [step.name]
    while pending:
        name = pending.pop()
        if name not in names:
            names.add(name)
            pending.extend(graph.steps[name].parents)
    kept = {name: each for name, each in graph.steps.items() if name in names}
    return replace(graph, steps=frozen(kept), groups=frozen({}), comments=frozen({}))


def _carriers(graph: Graph, wire: Wire) -> list[Wire]:
    """What an output can be shown on: of its step, and of those before, nearest first."""
    kinds = carrier_types(wire.type)
    if wire.step.is_mapped or not kinds:
        return []
    found: list[Wire] = []
    seen, pending = {wire.step.name}, [wire.step.name]
    while pending and len(found) < MOST_CARRIERS:
        step = graph.steps[pending.pop(0)]
        if not step.is_mapped:
            found += [
                w for w in step.wires if has_kind(w.type, kinds) and w.port is not wire.port
            ]
        fresh = [name for name in step.parents if name not in seen]
        seen.update(fresh)
        pending += fresh
    return found[:MOST_CARRIERS]


def _export(graph: Graph, order: Told, context: Context) -> str:
    """Run what writes files, and everything that nothing uses, into a folder."""
    writers = [step for step in graph.steps.values() if step.node.is_writer]
    if not writers:
        raise GraphError("no step writes a file: add one, such as write_step or write_view")
    ready = [step for step in writers if not step.unfinished]
    for step in ready:
        check_graph_files(_needed(graph.specification, step), context.files)

    def _note(event: Event) -> None:
        context.tell(_said(order, {"type": "step", **_event(event)}))

    folder = context.files / order["folder"]
    with output_folder(folder, overwrite=bool(order.get("overwrite"))) as output:
        try:
            graph.run(
                *ready, on_event=_note, cancel=context.cancel, read_from=context.files,
                write_to=output,
            )  # fmt: skip
        finally:
            _tell_messages(graph, ready, order, context)
        files = sorted(
            path.relative_to(output.staging).as_posix()
            for path in output.staging.rglob("*")
            if path.is_file()
        )
    return "\n".join(files)
