// Triangles, lines and surfaces in arrays that grow.

const LITTLE = 1 << 10;

function grown(array, length) {
  if (array.length >= length) return array;
  const result = new array.constructor(Math.max(2 * array.length, length));
  result.set(array);
  return result;
}

/** Vertices and triangles: points in whole models' sizes, each with its surface and light. */
export class Soup {
  /** Room for so many vertices, and more as it is needed. */
  constructor(room = LITTLE) {
    const count = Math.max(1, room);
    this.size = this.corners = 0;
    this.points = new Float32Array(3 * count);
    this.owners = new Float32Array(count);
    this.shares = new Uint8Array(2 * count);
    this.kinds = new Uint8Array(count);
    this.ids = new Uint32Array(6 * count);
  }

  get positions() { return this.points.subarray(0, 3 * this.size); }
  get surfaces() { return this.owners.subarray(0, this.size); }
  get lights() { return this.shares.subarray(0, 2 * this.size); }
  get sides() { return this.kinds.subarray(0, this.size); }
  get triangles() { return this.ids.subarray(0, this.corners); }

  vertex(x, y, z, surface, side, up, down) {
    const i = this.size++;
    if (i >= this.owners.length) {
      this.points = grown(this.points, 3 * i + 3);
      this.owners = grown(this.owners, i + 1);
      this.shares = grown(this.shares, 2 * i + 2);
      this.kinds = grown(this.kinds, i + 1);
    }
    this.points[3 * i] = x;
    this.points[3 * i + 1] = y;
    this.points[3 * i + 2] = z;
    this.owners[i] = surface;
    this.kinds[i] = side;
    this.shares[2 * i] = up;
    this.shares[2 * i + 1] = down;
    return i;
  }

  triangle(a, b, c) {
    const k = this.corners;
    this.ids = grown(this.ids, k + 3);
    this.ids[k] = a;
    this.ids[k + 1] = b;
    this.ids[k + 2] = c;
    this.corners = k + 3;
  }

  /** Triangles of a pattern that is counted from its first vertex. */
  pattern(first, triangles) {
    this.ids = grown(this.ids, this.corners + triangles.length);
    for (let k = 0; k < triangles.length; k++) this.ids[this.corners + k] = first + triangles[k];
    this.corners += triangles.length;
  }

  /** Between two rows of n vertices each, seen from the side of `low` × `high`. */
  strip(low, high, n) {
    for (let i = 0; i + 1 < n; i++) {
      this.triangle(low + i, low + i + 1, high + i + 1);
      this.triangle(low + i, high + i + 1, high + i);
    }
  }

  point(i) { return [this.points[3 * i], this.points[3 * i + 1], this.points[3 * i + 2]]; }
}

/** Segments of lines, each end with its part. */
export class Lines {
  constructor(room = LITTLE) {
    const count = Math.max(1, room);
    this.size = 0;
    this.points = new Float32Array(3 * count);
    this.owners = new Float32Array(count);
  }

  get positions() { return this.points.subarray(0, 3 * this.size); }
  get parts() { return this.owners.subarray(0, this.size); }

  end(x, y, z, part) {
    const i = this.size++;
    if (i >= this.owners.length) {
      this.points = grown(this.points, 3 * i + 3);
      this.owners = grown(this.owners, i + 1);
    }
    this.points[3 * i] = x;
    this.points[3 * i + 1] = y;
    this.points[3 * i + 2] = z;
    this.owners[i] = part;
  }

  add(p, q, part) {
    this.end(p[0], p[1], p[2], part);
    this.end(q[0], q[1], q[2], part);
  }

  /** Between two vertices of a soup. */
  between(soup, a, b, part) {
    const { points } = soup;
    this.end(points[3 * a], points[3 * a + 1], points[3 * a + 2], part);
    this.end(points[3 * b], points[3 * b + 1], points[3 * b + 2], part);
  }
}

/** Surfaces: three texels each, see `shapes.js`. */
export class Surfaces {
  constructor(room = LITTLE) {
    this.length = 0;
    this.rows = new Float32Array(12 * Math.max(1, room));
  }

  /** The plane, sphere or cylinder with normal n at p, curvature A and an axis. */
  add(n, A, p, part, axis) {
    const i = this.length++, k = 12 * i;
    this.rows = grown(this.rows, k + 12);
    const { rows } = this;
    rows[k] = n[0]; rows[k + 1] = n[1]; rows[k + 2] = n[2]; rows[k + 3] = A;
    rows[k + 4] = p[0]; rows[k + 5] = p[1]; rows[k + 6] = p[2]; rows[k + 7] = part;
    if (axis) { rows[k + 8] = axis[0]; rows[k + 9] = axis[1]; rows[k + 10] = axis[2]; }
    return i;
  }

  /** As texels of a picture so wide. */
  texels(width) {
    const height = Math.max(1, Math.ceil((3 * this.length) / width));
    this.rows = grown(this.rows, 4 * width * height);
    return [this.rows.subarray(0, 4 * width * height), height];
  }
}
