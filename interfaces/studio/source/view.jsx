// A picture of a result, drawn by the viewer of the page.

import { useEffect, useMemo, useRef, useState } from "react";
import { now, set, useStudio } from "./store.js";

let viewerModule = null;
const viewer = () => (viewerModule ??= import("/studio/viewer.js"));
const PLAIN = [226, 226, 222], GHOST = [236, 238, 240], BEAM = [166, 132, 98], NODE = [98, 102, 110], NONE = [190, 194, 199];
const views = new Map();

/** Views that look at models of about the same size follow each other; two that are swiped look from one place. */
function follow(leader) {
  if (leader.following) return;
  const { linked, swipe } = now();
  for (const [target, view] of views) {
    const isSwiped = swipe?.includes(target) && swipe.includes(leader.shows);
    // One that was made to fit its own place leads nobody.
    if (view === leader || !(isSwiped || (linked && !leader.fitted))) continue;
    view.following = true;
    view.camera.position.copy(leader.camera.position);
    view.controls.target.copy(leader.controls.target);
    if (isSwiped) for (const point of [view.camera.position, view.controls.target]) placed(point, leader.head, view.head);
    view.fitted = null;
    view.controls.update();
    view.draw();
    view.following = false;
  }
}

/** See all of a model from a direction, and so all that follow it. */
function fitAll(leader, direction) {
  const { linked, swipe } = now();
  if (linked && !swipe) for (const view of views.values()) view.fit(direction ?? view.head.home);
  else leader?.fit(direction ?? leader.head.home);
}

/** A point of one picture in the measures of another. */
function placed(point, from, to) {
  const moved = point.toArray().map((x, k) => (from.center[k] + from.size * x - to.center[k]) / to.size);
  point.set(...moved);
}

/** Whether a model is so much larger or smaller along some side that one has to look at it anew. */
function isOtherSize(before, after) {
  const sides = (head) => head.high.map((x, k) => head.size * Math.max(x - head.low[k], 0.1 * Math.max(...head.high)));
  const old = sides(before);
  return sides(after).some((side, k) => side > 2 * old[k] || old[k] > 2 * side);
}

/** Where a view looks from. */
const directionOf = (view) => view.camera.position.clone().sub(view.controls.target).normalize().toArray();

/** Colours of parts by the values of a scene, and the legend that says so. */
export function colored({ pathColor, scaleOf, number }, head, arrays, chosen) {
  const panels = head.panels.id.length, beams = head.beams.id.length, count = panels + beams + head.nodes.id.length;
  const size = 1024 * Math.ceil(Math.max(1, count) / 1024) * 4, colors = new Uint8Array(size).fill(255);
  const mode = head.colors[chosen], values = mode ? [...arrays[`value_${chosen}`]] : null;
  let legend = null, pick = () => (head.ghost ? GHOST : PLAIN);
  if (mode?.kind === "kinds") {
    const kinds = [...new Set(values)].sort((a, b) => a - b), place = new Map(kinds.map((kind, k) => [kind, k]));
    const shade = (k) => pathColor(kinds.length > 1 ? k / (kinds.length - 1) : 0);
    pick = (i) => shade(place.get(values[i]));
    const counts = new Map();
    for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
    legend = { kinds: kinds.slice(0, 48).map((kind, k) => ({ name: String(kind), color: shade(k), count: counts.get(kind) })) };
  } else if (mode) {
    const known = values.map((v) => (Number.isFinite(v) ? v : null));
    if (known.some((v) => v !== null)) {
      const { share } = scaleOf({ values: known, logarithmic: mode.name === "Radius" });
      pick = (i) => { const s = share(known[i]); return s === null ? NONE : pathColor(s); };
      const finite = known.filter((v) => v !== null);
      const low = finite.reduce((a, b) => Math.min(a, b)), high = finite.reduce((a, b) => Math.max(a, b));
      legend = { low: number(low), high: number(high), unit: mode.unit === "deg" ? "°" : mode.unit, path: [0, 0.25, 0.5, 0.75, 1].map(pathColor) };
    }
  }
  for (let i = 0; i < count; i++) colors.set([...(i < panels ? pick(i) : i < panels + beams ? BEAM : NODE), 255], 4 * i);
  return { colors, legend };
}

export function ModelView({ data, target }) {
  const canvas = useRef(null), stage = useRef(null), view = useRef(null);
  const [parts, setParts] = useState(null);
  const [chosen, setChosen] = useState(0);
  const [part, setPart] = useState(-1);
  const [fault, setFault] = useState("");
  // Where flat panels end and spheres begin, if they are compared.
  const [flat, setFlat] = useState(null);
  const { head, arrays } = data;
  // Beams are shown without the panels on them, which are there to be switched on.
  const [hidden, setHidden] = useState(() => (head.beams.id.length && head.ghost ? { panels: false } : {}));
  useEffect(() => { viewer().then(setParts, (error) => setFault(error.message)); }, []);
  const mode = Math.min(chosen, Math.max(0, head.colors.length - 1));
  const { colors, legend } = useMemo(() => (parts ? colored(parts, head, arrays, mode) : {}), [parts, data, mode]);

  useEffect(() => {
    if (!parts) return;
    const began = performance.now();
    const shapes = parts.buildShapes(head, arrays);
    if (view.current) view.current.load(head, arrays, shapes);
    else {
      try {
        view.current = new parts.View(canvas.current, head, arrays, shapes);
      } catch {
        setFault("This browser shows no WebGL: allow hardware acceleration to see models.");
        return;
      }
      const made = view.current;
      made.shows = target;
      made.head = head;
      made.freeSides = () => ({ left: 0.94, right: 0.94, below: 0.88, above: 0.9 });
      made.controls.addEventListener("change", () => follow(made));
      views.set(target, made);
    }
    const made = view.current;
    made.visible = { ...made.visible, edges: head.edges, ...hidden };
    made.setColors(colors);
    made.resize();
    if (!made.placed) made.fit(head.home);
    else if (isOtherSize(made.head, head)) made.fit(directionOf(made));
    made.placed = true;
    made.head = head;
    const partner = now().swipe?.find((each) => each !== target);
    if (partner && now().swipe.includes(target) && views.has(partner)) follow(views.get(partner));
    setPart(-1);
    window.studioViews = views;
    window.studioDrawn = (window.studioDrawn ?? 0) + 1;
    window.studioDrawing = performance.now() - began;
  }, [parts, data]);
  useEffect(() => { if (colors && view.current) view.current.setColors(colors); }, [colors]);
  useEffect(() => { if (view.current) { Object.assign(view.current.visible, hidden); view.current.draw(); } }, [hidden]);
  useEffect(() => {
    if (!view.current) return;
    Object.assign(view.current, { flat: flat === null ? "off" : "swipe", swipe: flat ?? 0.5 });
    view.current.draw();
  }, [flat, parts, data]);
  useEffect(() => {
    const watch = new ResizeObserver(() => view.current?.resize());
    watch.observe(stage.current);
    return () => { watch.disconnect(); views.delete(target); view.current?.dispose(); view.current = null; };
  }, []);

  const down = useRef(null);
  const pick = (event) => {
    if (!view.current || !down.current || Math.hypot(event.clientX - down.current[0], event.clientY - down.current[1]) > 5) return;
    const box = canvas.current.getBoundingClientRect(), found = view.current.pick(event.clientX - box.left, event.clientY - box.top);
    view.current.select(found);
    setPart(found);
  };
  const turn = (event) => {
    const by = { ArrowLeft: [0.08, 0], ArrowRight: [-0.08, 0], ArrowUp: [0, 0.06], ArrowDown: [0, -0.06] }[event.key];
    if (by) view.current?.orbit(...by);
    else if (event.key.toLowerCase() === "f") view.current?.fit(head.home);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const layers = [["panels", head.panels.id.length, head.ghost && !head.beams.id.length ? "mesh" : "panels"], ["beams", head.beams.id.length, "beams"], ["nodes", head.nodes.id.length, head.beams.id.length ? "nodes" : "lines"]].filter(([, count]) => count);
  const isCurved = !head.ghost && head.panels.id.length > 0 && arrays.curvatures?.some((a) => a !== 0);
  return (
    <div className="model" ref={stage} data-target={target}>
      <canvas ref={canvas} tabIndex={0} aria-label={`${target}: ${head.words}. Arrow keys turn it, F shows all of it.`} onKeyDown={turn}
        onPointerDown={(event) => { down.current = event.isPrimary ? [event.clientX, event.clientY] : null; }} onPointerUp={pick} />
      {fault ? <p className="overlay message">{fault}</p> : null}
      <div className="overlay words">{head.words}{part >= 0 ? <b>{partText(parts, head, arrays, part)}</b> : null}</div>
      <div className="overlay tools">
        {layers.length > 1 ? layers.map(([key, , name]) => (
          <button key={key} className="layer" aria-pressed={hidden[key] !== false} title={hidden[key] === false ? `show ${name}` : `hide ${name}`} onClick={() => setHidden({ ...hidden, [key]: hidden[key] === false })}>{name}</button>
        )) : null}
        {isCurved ? <button aria-pressed={flat !== null} className="choice" title="left of the line every panel is flat" onClick={() => setFlat(flat === null ? 0.5 : null)}>Flat | spheres</button> : null}
        <button onClick={() => fitAll(view.current, null)} aria-label="see all of it">Fit</button>
        <button onClick={() => fitAll(view.current, [0, -0.001, 1])}>Top</button>
      </div>
      {flat !== null ? <SwipeLine at={flat} setAt={setFlat} names={["flat", "spheres"]} /> : null}
      {head.colors.length ? <Legend colors={head.colors} chosen={mode} setChosen={setChosen} legend={legend} /> : null}
    </div>
  );
}

function partText(parts, head, arrays, part) {
  const panels = head.panels.id.length, beams = head.beams.id.length;
  const name = part < panels ? head.panels.id[part] : part < panels + beams ? head.beams.id[part - panels] : head.nodes.id[part - panels - beams];
  if (part >= panels) return name ?? "";
  const values = head.colors.map((mode, k) => `${mode.name.toLowerCase()} ${mode.kind === "kinds" ? arrays[`value_${k}`][part] : parts.number(arrays[`value_${k}`][part])}${mode.unit === "deg" ? "°" : mode.unit ? ` ${mode.unit}` : ""}`);
  return [name, ...values].join(" · ");
}

const css = (color) => `rgb(${color.join(",")})`;

function Legend({ colors, chosen, setChosen, legend }) {
  return (
    <div className="overlay legend">
      {colors.length > 1 ? (
        <select aria-label="colour by" value={chosen} onChange={(event) => setChosen(Number(event.target.value))}>
          {colors.map((each, k) => <option key={each.name} value={k}>{each.name}</option>)}
        </select>
      ) : <span>{colors[0].name}</span>}
      {legend?.kinds ? <div className="kinds">{legend.kinds.map((kind) => <span key={kind.name} title={`${kind.count} parts`}><i style={{ background: css(kind.color) }} />{kind.name}</span>)}</div> : null}
      {legend?.path ? <div className="bar"><span>{legend.low}{legend.unit}</span><i style={{ background: `linear-gradient(90deg, ${legend.path.map(css).join(",")})` }} /><span>{legend.high}{legend.unit}</span></div> : null}
    </div>
  );
}

/** The picture of a model as a file. */
export function savePicture() {
  const [target, view] = [...views.entries()][0] ?? [];
  if (!view) return false;
  view.drawNow();
  const link = document.createElement("a");
  link.download = `${target.replace(".", " ")}.png`;
  link.href = view.canvas.toDataURL("image/png");
  link.click();
  return true;
}

export const LinkButton = () => {
  const linked = useStudio((s) => s.linked);
  return <button aria-pressed={linked} title="views turn together" onClick={() => set({ linked: !linked })}>Turn together</button>;
};

/** The line between two pictures: dragged, or moved by arrows. */
export function SwipeLine({ at, setAt, names }) {
  const line = useRef(null);
  const move = (share) => setAt(Math.min(0.98, Math.max(0.02, share)));
  return (
    <div className="swipeline" ref={line} style={{ left: `${100 * at}%` }} role="slider" tabIndex={0} aria-label={`between ${names.join(" and ")}`}
      aria-valuemin={0} aria-valuemax={100} aria-valuenow={Math.round(100 * at)}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={(event) => {
        if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
        const box = line.current.parentElement.getBoundingClientRect();
        move((event.clientX - box.left) / box.width);
      }}
      onKeyDown={(event) => {
        const by = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
        if (!by) return;
        event.preventDefault();
        event.stopPropagation();
        move(at + by);
      }}>
      <span>{names[0]}</span><span>{names[1]}</span>
    </div>
  );
}
