// Everything that the mouse does, by keys.

import { fragmentOf, paste, removeSelected } from "./clipboard.js";
import { bestOutput, cancel, edit, now, pinsOf, redo, set, show, undo } from "./store.js";

export const KEYS = [
  ["A or /", "add a step"], ["Tab", "next step"], ["Enter", "show its output"], ["C", "connect it to …"], ["Arrows", "move it"], ["F2", "rename"],
  ["M", "comment"], ["P", "pin what is shown"], ["G", "group, Shift+G ungroup"], ["Delete", "remove"], ["Ctrl+Z", "undo, Ctrl+Y redo"],
  ["Ctrl+C", "copy, Ctrl+X cut, Ctrl+V paste"], ["Ctrl+D", "the same again"], ["Ctrl+A", "select all"], ["F", "see all"], ["L", "lay out anew"],
  ["O", "open"], ["E", "export"], ["?", "these keys"], ["Esc", "close, or stop the run"],
];

const isTyping = (element) => Boolean(element?.closest?.("input:not([type=checkbox]):not([type=range]), textarea, select"));

export function togglePin(output) {
  const pins = pinsOf(now().doc.graph);
  edit([{ op: "pin", outputs: pins.includes(output) ? pins.filter((pin) => pin !== output) : [...pins, output] }]);
}

export function groupSelected() {
  const steps = now().selected.filter((id) => id.startsWith("s:")).map((id) => id.slice(2));
  if (!steps.length) return;
  const taken = now().doc.graph.groups ?? {};
  let number = 1;
  while (`Group ${number}` in taken) number++;
  edit([{ op: "group", name: `Group ${number}`, steps }]);
}

export function ungroupSelected() {
  const { selected, doc } = now(), groups = Object.entries(doc.graph.groups ?? {});
  const names = groups.filter(([name, members]) => selected.includes(`g:${name}`) || members.some((each) => selected.includes(`s:${each}`))).map(([name]) => name);
  if (names.length) edit(names.map((name) => ({ op: "group", name, steps: [] })));
}

/** The node that has the focus, or else the one that is selected. */
function present() {
  const node = document.activeElement?.closest?.(".react-flow__node");
  const id = node?.dataset.id;
  if (id) return id;
  return now().selected.length === 1 ? now().selected[0] : "";
}

const CONTROL = {
  z: (_, event) => (event.shiftKey ? redo() : undo()), y: () => redo(),
  d: (canvas) => paste(fragmentOf(now().selected), null), a: (canvas) => canvas.selectAll(), s: () => set({ dialog: { kind: "save" } }),
};

const PLAIN = {
  a: (canvas) => set({ dialog: { kind: "palette", at: canvas.middle() } }),
  "/": (canvas) => set({ dialog: { kind: "palette", at: canvas.middle() } }),
  f: () => set((s) => ({ fit: s.fit + 1 })), l: (canvas) => canvas.tidy(), o: () => set({ dialog: { kind: "open" } }), e: () => set({ dialog: { kind: "export" } }),
  "?": () => set({ dialog: { kind: "keys" } }),
  c: () => { const id = present(); if (id && !id.startsWith("g:")) set({ dialog: { kind: "connect", end: { id } } }); },
  f2: () => { const id = present(); if (id) set({ dialog: { kind: "rename", id } }); },
  m: () => { const id = present(); set({ dialog: { kind: "comment", step: id.startsWith("s:") ? id.slice(2) : "" } }); },
  p: () => { if (now().shown) togglePin(now().shown); },
  g: (_, event) => (event.shiftKey ? ungroupSelected() : groupSelected()),
  enter: (canvas, event) => {
    const id = present();
    if (!id.startsWith("s:") || event.target.closest("button")) return false;
    canvas.select([id]);
    const output = bestOutput(now(), id.slice(2));
    if (output) show(output);
    return true;
  },
  delete: (canvas) => remove(canvas), backspace: (canvas) => remove(canvas),
};

function remove(canvas) {
  const wires = [...canvas.picked()];
  const focused = document.activeElement?.closest?.(".react-flow__node")?.dataset.id, { graph } = now().doc;
  const isThere = (id) => id.slice(2) in ({ s: graph.steps, p: graph.params, g: graph.groups }[id[0]] ?? {});
  const chosen = now().selected.filter(isThere), selected = chosen.length || !focused ? chosen : [focused];
  if (selected.length) removeSelected(selected);
  else if (wires.length) edit(wires.map((id) => { const to = id.split(">")[1]; return { op: "take", step: to.split(".")[0], port: to.split(".")[1] }; }));
}

export function keyPressed(event, canvas) {
  const { dialog, running } = now();
  if (event.key === "Escape") {
    if (dialog) set({ dialog: null });
    else if (running) cancel();
    return;
  }
  if (dialog || isTyping(event.target) || event.altKey) return;
  const key = event.key.toLowerCase(), isControl = event.ctrlKey || event.metaKey;
  const act = isControl ? CONTROL[key] : PLAIN[key];
  if (!act || (!isControl && event.target.matches?.("input"))) return;
  if (act(canvas, event) !== false) event.preventDefault();
}
