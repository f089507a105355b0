"""The run itself: keys first, then only the steps whose results are not known."""

import warnings
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

from ..annotations import Value
from ..errors import GraphError
from ..node import NodeWarning, replaced
from ..ports import Port
from ..specification.wires import Each, Param, Step, Wire, sources
from ..stores.entries import Entry, Store
from ..stores.results import own, snapshot
from .calls import Call, Caller, failure, file_part, perform, perform_each
from .events import Event, RunCancelledError, Watch
from .files import FileUses, Folders, is_file, is_wired, is_written, note_known_files
from .keys import given_part, key_of, node_part

Aliases: TypeAlias = Mapping[str, Mapping[str, Wire]]

_running: ContextVar["Run | None"] = ContextVar("running", default=None)
_IMMUTABLE: Final = frozenset((int, float, bool, str, type(None), Wire, Param))


@dataclass(frozen=True, eq=False)
class Run:
    """A run under way: nobody else changes what it is given.

    Attributes
    ----------
    steps : mapping of str to Step
        The steps of the graph, each after those it depends on.
    values : mapping of str to object
        Values of the sliders.
    store : Store
        Results of earlier runs.
    watch : Watch
        Who looks on.
    folders : Folders
        Where the relative paths are that nodes read and write. What a step has written is read
        where it was written.
    aliases : mapping of str to mapping of str to Wire
        What the outputs of steps that are inner graphs are, by name and port.
    entries : dict of str to Entry
        Results at hand so far.
    given : dict of (str, str) to object
        Literals of steps by input, as they were when first asked for.
    node_parts : dict of int to bytes
        What keys say of nodes, by their id.
    passing : set of str
        Steps whose keys hold a folder that will be gone: of no use to another process.
    """

    steps: Mapping[str, Step]
    values: Mapping[str, Any]
    units: str
    store: Store
    watch: Watch = field(default_factory=Watch)
    folders: Folders = field(default_factory=Folders)
    aliases: Aliases = field(default_factory=dict[str, Mapping[str, Wire]])
    keys: dict[str, bytes] = field(default_factory=dict[str, bytes])
    entries: dict[str, Entry] = field(default_factory=dict[str, Entry])
    given: dict[tuple[str, str], Value] = field(default_factory=dict[tuple[str, str], Value])
    node_parts: dict[int, bytes] = field(default_factory=dict[int, bytes])
    passing: set[str] = field(default_factory=set[str])


def running() -> Run | None:
    """The run that the present function is called by, if there is one."""
    return _running.get()


def run_steps(run: Run, targets: Iterable[Step | Wire | Param]) -> None:
    """Bring the entries of steps up to date, running as little as possible.

    Parameters
    ----------
    run : Run
        Its keys and entries are filled in.
    targets : iterable of Step, Wire or Param

    Raises
    ------
    NodeError
        If a step fails.
    GraphError
        If a step is not finished.
    RunCancelledError
        If the run is called off; what is done is kept.
    """
    wanted = list(dict.fromkeys(name for t in targets for name in _names(run, t)))
    needed = _ancestors(run, wanted)
    for step in needed:
        if step.unfinished:
            raise GraphError(f"step {step.name!r} is not finished: {step.unfinished}")
        for text in replaced(step.node):
            warnings.warn(f"step {step.name!r}: {text}", NodeWarning, stacklevel=3)
    with_files = [step for step in needed if step.node.file_inputs]
    uses = FileUses(run.folders)
    note_known_files(uses, with_files, run.values)
    for step in needed:
        if step.node.file_inputs:
            ports = step.node.inputs
            files = [source for name, source in step.sources if is_file(ports[name])]
            # The state of a file is part of the key, so its path must be known before.
            _bring(run, [w.step.name for w in files if isinstance(w, Wire)])
            _note_files(run, step, uses)
        run.keys[step.name] = key_of((_node_part(run, step), *_parts(run, step).values()))
    writers = [step.name for step in with_files if step.node.is_writer]
    _bring(run, [*wanted, *writers])


def output(run: Run, source: Step | Wire | Param) -> Value:
    """The value of a target.

    Parameters
    ----------
    run : Run
        A run that has reached it.

    Returns
    -------
    object
        What the function returned, one field of it, or the value of the slider.
    """
    if isinstance(source, Param):
        return own(run.values[source.name])
    step = source.step if isinstance(source, Wire) else source
    if step.name in run.aliases:
        wires = run.aliases[step.name]
        if isinstance(source, Wire) or len(wires) == 1:
            port = source.port.name if isinstance(source, Wire) else next(iter(wires))
            return output(run, wires[port])
        return step.node.result_type(*(output(run, wire) for wire in wires.values()))
    value = run.entries[step.name].value
    if isinstance(source, Wire) and step.node.has_fields:
        value = getattr(value, source.port.name)
    return own(value)


def _names(run: Run, target: Step | Wire | Param) -> list[str]:
    """The steps that a target is of; those within an inner graph that give its outputs."""
    if isinstance(target, Param):
        return []
    step = target.step if isinstance(target, Wire) else target
    if step.name not in run.aliases:
        return [step.name]
    wires = run.aliases[step.name]
    ports = [target.port.name] if isinstance(target, Wire) else list(wires)
    return [wires[port].step.name for port in ports]


def _ancestors(run: Run, targets: Iterable[str]) -> list[Step]:
    names, pending = set[str](), list(targets)
    while pending:
        name = pending.pop()
        if name not in names:
            names.add(name)
            pending.extend(run.steps[name].parents)
    return [step for name, step in run.steps.items() if name in names]


def _bring(run: Run, targets: Iterable[str]) -> None:
    """Run what is missing for the targets; their keys and those before are known."""
    missing, seen, pending = set[str](), set[str](), list(targets)
    get, watch = run.store.get, run.watch
    while pending:
        name = pending.pop()
        if name in seen or name in run.entries:
            continue
        seen.add(name)
        entry = get(run.keys[name])
        if entry is None:
            missing.add(name)
            pending.extend(run.steps[name].parents)
        else:
            run.entries[name] = entry
            if watch.is_watched:
                watch.tell(Event(name, "cached", entry.seconds))
    if not missing:
        return
    order = [name for name in run.steps if name in missing]
    if watch.on_event is not None:
        for name in order:
            watch.tell(Event(name, "queued"))
    _make_all(run, order)


def _make_all(run: Run, order: list[str]) -> None:
    for i, name in enumerate(order):
        try:
            run.entries[name] = _make(run, run.steps[name])
        except (RunCancelledError, KeyboardInterrupt, SystemExit):  # from us, or a signal
            for later in order[i:]:
                run.watch.tell(Event(later, "cancelled"))
            raise


def _make(run: Run, step: Step) -> Entry:
    """The result of a step that was missing: nobody else makes the same one meanwhile."""
    key, store, watch = run.keys[step.name], run.store, run.watch
    watch.check()
    with store.flight(key, watch.check):
        # asked again: a step before this one may have been its equal, or another run was first
        entry = store.get(key)
        if entry is not None:
            if watch.is_watched:
                watch.tell(Event(step.name, "cached", entry.seconds))
            return entry
        with watch.step(step.name):
            entry = _execute(run, step)
        size = store.put(key, entry, is_lasting=not _is_passing(run, step))
    if watch.is_watched:
        watch.tell(Event(step.name, "done", entry.seconds, size))
    return entry


def _is_passing(run: Run, step: Step) -> bool:
    """Whether a key holds the folder in which files stand until a job is done."""
    if not run.folders.is_staged:
        return False
    if step.node.is_writer or not run.passing.isdisjoint(step.parents):
        run.passing.add(step.name)
    return step.name in run.passing


def _execute(run: Run, step: Step) -> Entry:
    ports = step.node.inputs.values()
    try:
        arguments = {port.name: _argument(run, step, port) for port in ports}
        written = {
            port.name: _resolve(run, _given(run, step, port))
            for port in step.node.file_inputs
            if port.writes
        }
    except Exception as error:
        raise failure(run.folders, step, error) from error
    caller = Caller(run.store, run.watch, run.folders)
    token = _running.set(run)
    try:
        if step.is_mapped:
            call = Call(step, arguments, written, _parts(run, step, states=False))
            return perform_each(caller, call, _node_part(run, step))
        return perform(caller, Call(step, arguments, written, {}))
    finally:
        _running.reset(token)


def _given(run: Run, step: Step, port: Port) -> Value:
    """What an input was given when first asked for: somebody may still write to an array."""
    value = step.inputs.get(port.name, run.units if port.graph_units else port.default)
    if type(value) in _IMMUTABLE:
        return value
    at = step.name, port.name
    if at not in run.given:
        run.given[at] = value if any(sources(value)) else own(value, snapshot)
    return run.given[at]


def _note_files(run: Run, step: Step, uses: FileUses) -> None:
    """Note the files whose paths come by wires; those of writers are read, but no inputs."""
    for port in step.node.file_inputs:
        given = _given(run, step, port)
        if is_wired(given) and (port.writes or not is_written(given)):
            uses.note(step, port, _resolve(run, given))


def _argument(run: Run, step: Step, port: Port) -> Value:
    given = _given(run, step, port)
    value = _resolve(run, given)
    if not is_file(port):
        return value
    is_target = is_written(given) if port.reads else port.writes
    return run.folders.target(value) if is_target else run.folders.source(value)


def _resolve(run: Run, value: Value) -> Value:
    if isinstance(value, Each):
        return _resolve(run, value.items)
    if isinstance(value, Wire | Param):
        return output(run, value)
    if any(sources(value)):
        return [_resolve(run, item) for item in value]
    return own(value, snapshot)


def _parts(run: Run, step: Step, *, states: bool = True) -> dict[str, bytes]:
    """What the key of a step says of each input.

    Parameters
    ----------
    states : bool
        Whether to say it of files; those of mapped inputs are said of each item.
    """
    keys, values = run.keys.__getitem__, run.values.__getitem__
    parts: dict[str, bytes] = {}
    for name, port in step.node.inputs.items():
        given = _given(run, step, port)
        parts[name] = given_part(given, keys, values)
        if is_file(port) and (states or not isinstance(given, Each)):
            state = file_part(port, _argument(run, step, port), run.store.file_state)
            parts[name] = key_of([parts[name], state])
    return parts


def _node_part(run: Run, step: Step) -> bytes:
    node = step.node
    part = run.node_parts.get(id(node))
    if part is None:
        part = node_part(node, run.store.origin)
        if node.inner is not None:
            steps = node.inner.specification.steps.values()
            part = key_of([part, *(_node_part(run, step) for step in steps)])
        run.node_parts[id(node)] = part
    return part
