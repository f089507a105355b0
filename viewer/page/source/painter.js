// The picture where there is no WebGL: corners in perspective, the farthest painted first.

import { add, cross, dot, scale, sub, unit } from "./vectors.js";

export function paint(canvas, shapes, colors, home) {
  const ratio = Math.min(2, window.devicePixelRatio || 1), box = canvas.parentElement;
  canvas.width = box.clientWidth * ratio;
  canvas.height = box.clientHeight * ratio;
  const context = canvas.getContext("2d");
  if (!context) return;
  const back = unit(home), right = unit(cross([0, 0, 1], back)), up = cross(back, right);
  const sun = unit(add(unit([back[0] - 1.1 * right[0], back[1] - 1.1 * right[1], 0]), [0, 0, 1.15]));
  const eye = scale(back, 4);
  const flat = (p) => {
    const d = sub(p, eye), z = -dot(d, back);
    return [dot(d, right) / z, -dot(d, up) / z];
  };
  const all = shapes.corners.flat().map(flat), ends = [0, 1].map((k) => {
    const values = all.map((p) => p[k]);
    return [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
  });
  // Title and message stand above.
  const head = Math.min(130 * ratio, 0.3 * canvas.height), size = [canvas.width, canvas.height - head];
  const k = 0.88 * Math.min(...size.map((s, i) => s / (ends[i][1] - ends[i][0] || 1)));
  const project = (p) => flat(p).map((v, i) => i * head + size[i] / 2 + k * (v - (ends[i][0] + ends[i][1]) / 2));
  const order = shapes.corners.map((_, i) => i).sort((i, j) => dot(shapes.centers[i], back) - dot(shapes.centers[j], back));
  context.lineWidth = ratio * 0.6;
  context.strokeStyle = "rgba(34,38,43,.45)";
  for (const i of order) {
    const corners = shapes.corners[i];
    const n = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
    const outside = dot(n, sub(eye, corners[0])) > 0;
    const light = outside ? 0.62 + 0.38 * Math.max(0, dot(n, sun)) : 0.5;
    context.fillStyle = `rgb(${[0, 1, 2].map((k) => Math.round(light * colors[4 * i + k])).join(",")})`;
    context.globalAlpha = colors[4 * i + 3] ? 1 : 0.15;
    context.beginPath();
    corners.map(project).forEach(([x, y]) => context.lineTo(x, y));
    context.closePath();
    context.fill();
    context.stroke();
  }
  context.globalAlpha = 1;
}
