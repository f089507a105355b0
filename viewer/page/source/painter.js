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
  const spread = 1.75, eye = scale(back, 4);
  const project = (p) => {
    const d = sub(p, eye), z = -dot(d, back);
    const k = (spread * Math.min(canvas.width, canvas.height)) / z * 1.6;
    return [canvas.width / 2 + k * dot(d, right), canvas.height / 2 - k * dot(d, up)];
  };
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
