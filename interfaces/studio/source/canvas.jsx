// The canvas: steps, sliders, wires and groups under mouse, touch and keys.

import { applyNodeChanges, Background, BackgroundVariant, Panel, ReactFlow, ReactFlowProvider, useReactFlow } from "@xyflow/react";
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import { copied, pasted } from "./clipboard.js";
import { given, layout, placesOf, sizeOf, whyNot, wiresOf } from "./graph.js";
import { keyPressed } from "./keys.js";
import { Empty } from "./start.jsx";
import { bestOutput, edit, now, set, show, useStudio } from "./store.js";
import { GroupNode, SliderNode, Sliders, StepNode } from "./step.jsx";

const NODE_TYPES = { step: StepNode, slider: SliderNode, group: GroupNode };
/** Below these zooms sliders are too small for a hand, nobody reads fields, nobody reads names. */
const SMALL = 0.75, FAR = 0.3, FARTHER = 0.12;
const PADDING = { top: 44, side: 18, bottom: 18 };

/** Nodes as the graph has them; what the canvas knows of them, such as their sizes, is kept. */
function nodesOf(s, before) {
  const places = placesOf(s), known = new Map(before.map((node) => [node.id, node]));
  const made = (id, type, data, more = {}) => {
    const [x, y] = places[id] ?? [0, 0], old = known.get(id);
    // What is on its way stays under the hand.
    const isHeld = old && (old.dragging || unkept.has(id));
    const position = isHeld || (old && old.position.x === x && old.position.y === y) ? old.position : { x, y };
    if (old && old.position === position && old.ariaLabel === more.ariaLabel) return old;
    return { ...(old ?? {}), id, type, data: old?.data ?? data, position, ...more };
  };
  const nodes = [
    ...Object.keys(s.doc.graph.params).map((name) => made(`p:${name}`, "slider", { name }, { ariaLabel: `slider ${name}` })),
    ...Object.keys(s.doc.graph.steps).map((name) => made(`s:${name}`, "step", { name }, { ariaLabel: `step ${name}` })),
  ];
  return [...groupsOf(s, nodes, known), ...nodes];
}

/** Groups stand around their members. */
function groupsOf(s, nodes, known) {
  const found = [], byId = new Map(nodes.map((node) => [node.id, node]));
  for (const [name, members] of Object.entries(s.doc.graph.groups ?? {})) {
    const boxes = members.map((each) => byId.get(`s:${each}`)).filter(Boolean).map((node) => {
      const [w, h] = sizeOf(s, node.id);
      return [node.position.x, node.position.y, node.position.x + (node.measured?.width ?? w), node.position.y + (node.measured?.height ?? h)];
    });
    if (!boxes.length) continue;
    const low = [0, 1].map((k) => Math.min(...boxes.map((b) => b[k]))), high = [2, 3].map((k) => Math.max(...boxes.map((b) => b[k])));
    const position = { x: low[0] - PADDING.side, y: low[1] - PADDING.top }, id = `g:${name}`, old = known.get(id);
    const data = { name, width: high[0] - low[0] + 2 * PADDING.side, height: high[1] - low[1] + PADDING.top + PADDING.bottom };
    const isSame = old && JSON.stringify(old.data) === JSON.stringify(data) && old.position.x === position.x && old.position.y === position.y;
    found.push(isSame ? old : { ...(old ?? {}), id, type: "group", data, position, zIndex: -1, dragHandle: ".grouptitle", ariaLabel: `group ${name}`, width: data.width, height: data.height });
  }
  return found;
}

function edgesOf(s) {
  return wiresOf(s).map((wire) => ({
    id: wire.id, source: wire.source, sourceHandle: wire.sourceHandle, target: wire.target, targetHandle: wire.targetHandle,
    className: `wire f-${wire.family}${wire.isEach ? " each" : ""}`, focusable: true, ariaLabel: `wire ${wire.id}`, interactionWidth: 18,
  }));
}

function Flow() {
  const doc = useStudio((s) => s.doc), fit = useStudio((s) => s.fit), refusal = useStudio((s) => s.refusal), expanded = useStudio((s) => s.expanded);
  const [nodes, setNodes] = useState([]);
  const [picked, setPicked] = useState(new Set());
  const [isSmall, setSmall] = useState(false);
  const flow = useReactFlow(), held = useRef(null), moving = useRef(null), forgetting = useRef(0), fitted = useRef(-1), box = useRef(null);
  useEffect(() => { setNodes((before) => nodesOf(now(), before)); }, [doc, expanded]);
  const edges = useMemo(() => edgesOf(now()).map((edge) => (picked.has(edge.id) ? { ...edge, selected: true } : edge)), [doc, picked]);
  useEffect(() => {
    const selected = nodes.filter((node) => node.selected).map((node) => node.id);
    if (selected.join() !== now().selected.join()) set({ selected });
  }, [nodes]);
  const measured = nodes.length > 0 && nodes.every((node) => node.type === "group" || node.measured?.width);
  useEffect(() => {
    if (fitted.current === fit || (!measured && nodes.length)) return;
    fitted.current = fit;
    flow.fitView({ padding: 0.08, maxZoom: 1, minZoom: 0.25 });
  }, [fit, measured, nodes.length]);
  useEffect(() => {
    // Sizes are known only when steps stand on the canvas: groups follow.
    if (measured && Object.keys(doc?.graph.groups ?? {}).length) setNodes((before) => withGroups(before));
  }, [measured, doc]);

  const onNodesChange = useCallback((changes) => {
    setNodes((before) => {
      const after = applyNodeChanges(changes.filter((change) => change.type !== "remove"), before);
      return changes.some((change) => change.type === "position" || change.type === "dimensions") && after.some((node) => node.type === "group") ? withGroups(after) : after;
    });
    keptByKeys(changes, flow);
  }, []);
  const onEdgesChange = useCallback((changes) => {
    const chosen = changes.filter((change) => change.type === "select");
    if (chosen.length) setPicked((before) => {
      const after = new Set(before);
      for (const change of chosen) { if (change.selected) after.add(change.id); else after.delete(change.id); }
      return after;
    });
  }, []);

  const isValid = useCallback((wire) => {
    const why = whyNot(now(), wire.source, wire.sourceHandle, wire.target, wire.targetHandle);
    if (why !== now().refusal) queueMicrotask(() => set({ refusal: why }));
    return !why;
  }, []);
  const onConnect = useCallback((wire) => {
    const value = given(now(), wire.source, wire.sourceHandle, wire.target, wire.targetHandle);
    edit([{ op: "give", step: wire.target.slice(2), port: wire.targetHandle, value }]);
  }, []);
  const onConnectStart = useCallback((_, { nodeId, handleId, handleType }) => {
    held.current = handleType === "source" ? { id: nodeId, output: handleId } : { id: nodeId, input: handleId };
    clearTimeout(forgetting.current);
    set({ refusal: "" });
  }, []);
  const onConnectEnd = useCallback((event, wire) => {
    const end = held.current;
    held.current = null;
    clearTimeout(forgetting.current);
    forgetting.current = setTimeout(() => set({ refusal: "" }), wire?.toHandle && !wire.isValid ? 8000 : 0);
    if (!end || wire?.toHandle || wire?.toNode) return;
    const point = "changedTouches" in event ? event.changedTouches[0] : event;
    if (!box.current?.contains(document.elementFromPoint(point.clientX, point.clientY))) return;
    set({ dialog: { kind: "palette", at: flow.screenToFlowPosition({ x: point.clientX, y: point.clientY }), end } });
  }, []);
  const onReconnect = useCallback((old, wire) => {
    const ops = [{ op: "take", step: old.target.slice(2), port: old.targetHandle }];
    const value = given(now(), wire.source, wire.sourceHandle, wire.target, wire.targetHandle);
    edit([...ops, { op: "give", step: wire.target.slice(2), port: wire.targetHandle, value }]);
  }, []);

  const onDragStart = useCallback((_, node) => {
    if (node.type !== "group") return;
    const members = now().doc.graph.groups[node.data.name].map((each) => `s:${each}`);
    moving.current = { id: node.id, from: node.position, at: new Map(flow.getNodes().filter((each) => members.includes(each.id)).map((each) => [each.id, each.position])) };
  }, []);
  const onDrag = useCallback((_, node) => {
    const move = moving.current;
    if (!move || move.id !== node.id) return;
    const dx = node.position.x - move.from.x, dy = node.position.y - move.from.y;
    setNodes((before) => before.map((each) => (move.at.has(each.id) ? { ...each, position: { x: move.at.get(each.id).x + dx, y: move.at.get(each.id).y + dy } } : each)));
  }, []);
  const onDragStop = useCallback((_, node, dragged) => {
    const ids = moving.current ? [...moving.current.at.keys()] : dragged.map((each) => each.id);
    moving.current = null;
    for (const id of ids) unkept.add(id);
    setTimeout(() => keepPlaces(ids, flow).then(() => { for (const id of ids) unkept.delete(id); }), 0);
  }, []);
  const onNodeClick = useCallback((event, node) => {
    if (node.type !== "step" || event.target.closest("input, select, button, .react-flow__handle")) return;
    const output = bestOutput(now(), node.data.name);
    if (output && !now().shown.startsWith(`${node.data.name}.`)) show(output);
  }, []);
  const openPalette = useCallback((event) => {
    if (!event.target.classList.contains("react-flow__pane")) return;
    set({ dialog: { kind: "palette", at: flow.screenToFlowPosition({ x: event.clientX, y: event.clientY }) } });
  }, []);

  useEffect(() => {
    const middle = () => {
      const { left, top, width, height } = box.current.getBoundingClientRect();
      return flow.screenToFlowPosition({ x: left + width / 2, y: top + height / 2 });
    };
    const context = { flow, middle, picked: () => picked, selectAll: () => setNodes((before) => before.map((each) => ({ ...each, selected: true }))),
      select: (ids) => { set({ selected: ids }); setNodes((before) => before.map((each) => ({ ...each, selected: ids.includes(each.id) }))); },
      tidy: () => tidy(flow), reveal: (node) => reveal(node, box.current, flow) };
    canvasActions.current = context;
    const press = (event) => keyPressed(event, context);
    const copy = (event) => copied(event), paste = (event) => pasted(event, middle());
    document.addEventListener("keydown", press);
    document.addEventListener("copy", copy);
    document.addEventListener("cut", copy);
    document.addEventListener("paste", paste);
    return () => {
      document.removeEventListener("keydown", press);
      document.removeEventListener("copy", copy);
      document.removeEventListener("cut", copy);
      document.removeEventListener("paste", paste);
    };
  }, [picked]);

  /** Far away only names are read, and only they are drawn. */
  const onMove = useCallback((_, { zoom }) => {
    box.current?.classList.toggle("far", zoom < FAR);
    box.current?.classList.toggle("farther", zoom < FARTHER);
    setSmall(zoom < SMALL);
  }, []);

  return (
    <div className="canvas" ref={box} onDoubleClick={openPalette} data-nodes={nodes.length}>
      <ReactFlow nodes={nodes} edges={edges} nodeTypes={NODE_TYPES} onNodesChange={onNodesChange} onEdgesChange={onEdgesChange}
        isValidConnection={isValid} onConnect={onConnect} onConnectStart={onConnectStart} onConnectEnd={onConnectEnd}
        onClickConnectStart={onConnectStart} onClickConnectEnd={onConnectEnd} onReconnect={onReconnect}
        onNodeDragStart={onDragStart} onNodeDrag={onDrag} onNodeDragStop={onDragStop} onSelectionDragStop={(event, dragged) => onDragStop(event, null, dragged)}
        onMove={onMove} onNodeClick={onNodeClick} deleteKeyCode={null} zoomOnDoubleClick={false} minZoom={0.08} maxZoom={2} connectionRadius={26}
        selectionKeyCode="Shift" multiSelectionKeyCode={["Shift", "Meta", "Control"]} nodeDragThreshold={3} elevateNodesOnSelect={false}
        ariaLabelConfig={{ "node.a11yDescription.default": "Enter selects, arrows move, C connects, Delete removes." }}
        proOptions={{ hideAttribution: true }} fitView fitViewOptions={{ padding: 0.08, maxZoom: 1 }}>
        <Background variant={BackgroundVariant.Dots} gap={22} size={1.1} color="#d9dce1" />
        {refusal ? <Panel position="top-center" className="above"><div id="refusal" role="alert">{refusal}</div></Panel> : null}
        {isSmall ? <Panel position="bottom-left"><Sliders /></Panel> : null}
        {!nodes.length ? <Panel position="top-center"><Empty /></Panel> : null}
      </ReactFlow>
    </div>
  );
}

/** What keys of the canvas act on. */
export const canvasActions = { current: null };

/** Move the canvas until all of a node is seen, if it is not. */
function reveal(node, box, flow) {
  const inner = node.getBoundingClientRect(), outer = box.getBoundingClientRect(), { x, y, zoom } = flow.getViewport();
  // On a narrow canvas the list of sliders takes the lower part.
  const list = box.querySelector(".sliders")?.getBoundingClientRect();
  const low = list && list.width > outer.width / 2 ? list.top : outer.bottom;
  const off = (low, high, first, last) => (low < first ? first - low : Math.min(0, Math.max(last - high, first - low)));
  const dx = off(inner.left, inner.right, outer.left + 16, outer.right - 16), dy = off(inner.top, inner.bottom, outer.top + 16, low - 16);
  if (dx || dy) flow.setViewport({ x: x + dx, y: y + dy, zoom }, { duration: 200 });
}

function withGroups(nodes) {
  const s = now(), plain = nodes.filter((node) => node.type !== "group");
  return [...groupsOf(s, plain, new Map(nodes.map((node) => [node.id, node]))), ...plain];
}

/** Places of steps that were moved by hand; those of all others too, once one has been moved. */
export function keepPlaces(ids, flow) {
  const { graph } = now().doc, all = flow.getNodes().filter((node) => node.type !== "group");
  const isFirst = !graph.canvas?.steps && !graph.canvas?.params;
  const placed = (id) => (id.startsWith("s:") ? graph.canvas?.steps : graph.canvas?.params)?.[id.slice(2)];
  const steps = {}, params = {};
  for (const node of all) {
    const at = [Math.round(node.position.x), Math.round(node.position.y)];
    if (!isFirst && !ids.includes(node.id) && placed(node.id)) continue;
    (node.type === "step" ? steps : params)[node.data.name] = at;
  }
  const known = [...ids].some((id) => {
    const node = all.find((each) => each.id === id), at = placed(id);
    return node && (!at || at[0] !== Math.round(node.position.x) || at[1] !== Math.round(node.position.y));
  });
  return known ? edit([{ op: "move", steps, params }]) : Promise.resolve(true);
}

let byKeys = 0;
const unkept = new Set();
/** Arrows move nodes without a drag: their places are kept when the keys rest. */
function keptByKeys(changes, flow) {
  const ids = changes.filter((change) => change.type === "position" && change.dragging === false && change.position).map((change) => change.id);
  if (!ids.length) return;
  for (const id of ids) unkept.add(id);
  clearTimeout(byKeys);
  byKeys = setTimeout(() => {
    const moved = [...unkept];
    keepPlaces(moved, flow).then(() => { for (const id of moved) unkept.delete(id); });
  }, 350);
}

function tidy(flow) {
  const s = now(), ids = flow.getNodes().filter((node) => node.type !== "group").map((node) => node.id);
  const places = layout(s, ids), steps = {}, params = {};
  for (const id of ids) (id.startsWith("s:") ? steps : params)[id.slice(2)] = places[id];
  edit([{ op: "move", steps, params }]).then(() => set((old) => ({ fit: old.fit + 1 })));
}

export const Canvas = () => <ReactFlowProvider><Flow /></ReactFlowProvider>;
