// Where the eye stands: the camera that a model fits in, and directions.

import { add, cross, dot, unit } from "./vectors.js";

export const FIELD = 24; // degrees, upright
export const NAMED_VIEWS = {
  home: null, top: [0, -0.001, 1], front: [0, -1, 0.12], side: [1, 0, 0.12], below: [0.5, -0.7, -0.6],
};

/**
 * The nearest camera from a direction whose pyramid holds points: `frame_scene`. Of the sides
 * left, right, below and above the shares of the picture that are free. Its eye and its target.
 */
export function cameraThatFits(points, direction, aspect, sides) {
  const axes = viewAxes(direction), t = Math.tan((FIELD * Math.PI) / 360);
  // Of each pair of sides the slopes: left and right, below and above.
  const slopes = [[sides.left, sides.right].map((m) => t * aspect * m), [sides.below, sides.above].map((m) => t * m)];
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  let near = -Infinity, far = Infinity;
  for (const p of points) {
    const z = dot(axes[2], p);
    near = Math.max(near, z);
    far = Math.min(far, z);
    for (let k = 0; k < 2; k++) {
      const x = dot(axes[k], p), [s, r] = slopes[k];
      low[k] = Math.min(low[k], x - s * z);
      high[k] = Math.max(high[k], x + r * z);
    }
  }
  const distance = Math.max(...slopes.map(([s, r], k) => (high[k] - low[k]) / (s + r)));
  const middle = slopes.map(([s, r], k) => (low[k] + s * distance + high[k] - r * distance) / 2);
  const eye = [0, 1, 2].map((k) => axes[0][k] * middle[0] + axes[1][k] * middle[1] + axes[2][k] * distance);
  return [eye, add(eye, axes[2], (near + far) / 2 - distance)];
}

/** A direction, and those that lean from it by a sixth and a third of a half turn. */
export function sidewards(direction) {
  const [right, up, back] = viewAxes(direction), found = [keptUpright(back)];
  for (const lean of [30, 60].map((a) => (a * Math.PI) / 180)) {
    for (let k = 0; k < 6; k++) {
      const turn = (k * Math.PI) / 3, side = add(right.map((r) => r * Math.cos(turn)), up, Math.sin(turn));
      found.push(keptUpright(add(back.map((b) => b * Math.cos(lean)), side, Math.sin(lean))));
    }
  }
  return found;
}

/** The controls turn about the upright axis: nobody looks quite along it. */
const keptUpright = ([x, y, z]) => (Math.hypot(x, y) < 0.001 ? [x, y - 0.001, z] : [x, y, z]);

function viewAxes(direction) {
  const back = unit(direction);
  const upright = Math.abs(back[2]) < 0.9999 ? [0, 0, 1] : [0, 1, 0];
  const right = unit(cross(upright, back));
  return [right, cross(back, right), back];
}
