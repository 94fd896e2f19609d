// Software renderer of triangles and lines with a depth buffer.
// It needs no WebGL, so that prints and screenshots are equal to the screen.

class Raster {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.colour = new Uint32Array(width * height);
    this.depth = new Float32Array(width * height);
  }

  clear(colour) {
    this.colour.fill(colour);
    this.depth.fill(0);
  }

  // Points are [x, y, 1/distance]; 1/distance is linear on the screen.
  polygon(points, colour, alpha = 1) {
    for (let k = 1; k + 1 < points.length; k++) this.triangle(points[0], points[k], points[k + 1], colour, alpha);
  }

  triangle(a, b, c, colour, alpha) {
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if (!area) return;
    const dzdx = ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / area;
    const dzdy = ((c[2] - a[2]) * (b[0] - a[0]) - (b[2] - a[2]) * (c[0] - a[0])) / area;
    const top = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]) - 0.5));
    const bottom = Math.min(this.height - 1, Math.ceil(Math.max(a[1], b[1], c[1]) - 0.5) - 1);
    for (let row = top; row <= bottom; row++) {
      const y = row + 0.5;
      let low = Infinity, high = -Infinity;
      for (const [p, q] of [[a, b], [b, c], [c, a]]) {
        if ((p[1] <= y) === (q[1] <= y)) continue;
        const x = p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
        if (x < low) low = x;
        if (x > high) high = x;
      }
      const left = Math.max(0, Math.ceil(low - 0.5)), right = Math.min(this.width, Math.ceil(high - 0.5));
      let depth = a[2] + (left + 0.5 - a[0]) * dzdx + (y - a[1]) * dzdy;
      for (let k = row * this.width + left, end = row * this.width + right; k < end; k++, depth += dzdx) {
        if (depth <= this.depth[k]) continue;
        if (alpha < 1) this.colour[k] = blend(this.colour[k], colour, alpha);
        else { this.colour[k] = colour; this.depth[k] = depth; }
      }
    }
  }

  line(a, b, colour, width = 1) {
    const steps = Math.ceil(Math.max(Math.abs(b[0] - a[0]), Math.abs(b[1] - a[1])));
    if (!(steps > 0 && steps < 20000)) return;
    for (let s = 0; s <= steps; s++) {
      const t = s / steps, depth = (a[2] + t * (b[2] - a[2])) * 1.004;
      const x0 = Math.round(a[0] + t * (b[0] - a[0]) - width / 2), y0 = Math.round(a[1] + t * (b[1] - a[1]) - width / 2);
      for (let y = y0; y < y0 + width; y++) {
        for (let x = x0; x < x0 + width; x++) {
          if (x < 0 || y < 0 || x >= this.width || y >= this.height) continue;
          const k = y * this.width + x;
          if (depth > this.depth[k]) this.colour[k] = colour;
        }
      }
    }
  }

  image() {
    return new ImageData(new Uint8ClampedArray(this.colour.buffer), this.width, this.height);
  }
}

function rgb(r, g, b) {
  return (255 << 24 | b << 16 | g << 8 | r) >>> 0;
}

function blend(below, above, alpha) {
  const mix = shift => Math.round((below >>> shift & 255) * (1 - alpha) + (above >>> shift & 255) * alpha);
  return rgb(mix(0), mix(8), mix(16));
}
