// Vectors, and the solids of the 3-D view: arrows and sensor markers.

const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const sub = (a, b) => add(a, b, -1);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };

function around(axis, radius, sides) {
  const right = unit(cross(Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], axis)), up = cross(axis, right);
  return Array.from({ length: sides }, (_, k) => {
    const turn = 2 * Math.PI * k / sides;
    return add(add([0, 0, 0], right, radius * Math.cos(turn)), up, radius * Math.sin(turn));
  });
}

function cone(base, axis, length, radius, sides) {
  const rim = around(axis, radius, sides).map(p => add(base, p)), tip = add(base, axis, length);
  return rim.flatMap((p, k) => {
    const next = rim[(k + 1) % sides];
    return [[p, next, tip], [next, p, base]];
  });
}

function arrow(tail, axis, length, thickness) {
  const head = Math.min(0.4 * length, 9 * thickness), neck = add(tail, axis, length - head);
  const rim = around(axis, thickness, 8);
  const shaft = rim.flatMap((p, k) => {
    const q = rim[(k + 1) % 8];
    return [[add(tail, p), add(tail, q), add(neck, q)], [add(tail, p), add(neck, q), add(neck, p)]];
  });
  return shaft.concat(cone(neck, axis, head, 2.8 * thickness, 12));
}
