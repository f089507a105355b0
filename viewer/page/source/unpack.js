// What `viewer/page/container.py` has packed: a head of plain values, and arrays.

/** Head and arrays of the bytes of a model. */
export function decodeModel(data) {
  const length = new DataView(data.buffer, data.byteOffset).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + length)));
  const arrays = {};
  let start = 4 + length;
  for (const [name, kind, shape] of head.arrays) {
    const count = shape.reduce((a, b) => a * b, 1);
    const size = count * Number(kind[1]);
    arrays[name] = decode(data.subarray(start, start + size), kind, count, shape[0]);
    start += size;
  }
  return [head, arrays];
}

function decode(bytes, kind, count, rows) {
  if (kind === "u1") return bytes.slice();
  const words = new Uint32Array(count);
  const columns = rows ? count / rows : 0;
  // Bytes by significance, each of them by column, come back in rows.
  for (let column = 0, k = 0; column < columns; column++) {
    for (let row = 0; row < rows; row++, k++) {
      words[row * columns + column] = bytes[k] | (bytes[count + k] << 8)
        | (bytes[2 * count + k] << 16) | (bytes[3 * count + k] << 24);
    }
  }
  if (kind === "f4") return new Float32Array(words.buffer);
  const values = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    const step = (words[i] >>> 1) ^ -(words[i] & 1);
    values[i] = i < columns ? step : values[i - columns] + step;
  }
  return values;
}
