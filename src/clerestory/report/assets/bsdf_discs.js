// Discs of a hemisphere: coloured patches of a ring partition, and the patch at a point.

const DEGREE = Math.PI / 180;

async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

// The rings of a partition, with the number of their first patch.
class Rings {
  constructor({ theta, count, name }) {
    this.name = name;
    this.theta = theta;
    this.count = count;
    this.first = [];
    this.size = count.reduce((sum, n) => (this.first.push(sum), sum + n), 0);
    this.patches = [];
    count.forEach((n, ring) => {
      for (let k = 0; k < n; k++) {
        this.patches.push({
          ring, low: theta[ring], high: theta[ring + 1],
          from: 2 * Math.PI * (k - 0.5) / n, to: 2 * Math.PI * (k + 0.5) / n, whole: n === 1,
        });
      }
    });
  }

  find(theta, phi) {
    let ring = 0;
    while (ring < this.count.length - 1 && theta >= this.theta[ring + 1]) ring++;
    const n = this.count[ring], k = Math.floor(phi / (2 * Math.PI) * n + 0.5);
    return this.first[ring] + ((k % n) + n) % n;
  }

  // Polar angle and azimuth of the middle of a patch.
  middle(patch) {
    const { low, high, from, to, whole } = this.patches[patch];
    return whole && low === 0 ? [0, 0] : [(low + high) / 2, (from + to) / 2];
  }
}

// Disc on a canvas; with `turned`, each patch is drawn at the opposite azimuth.
class Disc {
  constructor(canvas, turned = false) {
    this.canvas = canvas;
    this.turned = turned ? -1 : 1;
  }

  resize() {
    const ratio = devicePixelRatio || 1, width = Math.max(80, this.canvas.clientWidth);
    this.canvas.width = this.canvas.height = Math.round(width * ratio);
    this.centre = this.canvas.width / 2;
    this.radius = this.centre - 17 * ratio;
    this.ratio = ratio;
  }

  place(theta, phi) {
    const r = this.radius * theta / (Math.PI / 2) * this.turned;
    return [this.centre + r * Math.cos(phi), this.centre - r * Math.sin(phi)];
  }

  outline(context, { low, high, from, to, whole }) {
    const scale = this.radius / (Math.PI / 2), turn = this.turned < 0 ? Math.PI : 0;
    context.beginPath();
    if (whole) {
      context.arc(this.centre, this.centre, high * scale, 0, 2 * Math.PI);
      if (low > 0) context.arc(this.centre, this.centre, low * scale, 0, 2 * Math.PI, true);
      return;
    }
    context.arc(this.centre, this.centre, high * scale, -to - turn, -from - turn);
    context.arc(this.centre, this.centre, low * scale, -from - turn, -to - turn, true);
    context.closePath();
  }

  draw(rings, colourOf, lines) {
    this.resize();
    this.rings = rings;
    const context = this.canvas.getContext("2d");
    rings.patches.forEach((patch, k) => {
      this.outline(context, patch);
      context.fillStyle = context.strokeStyle = colourOf(k);
      context.fill();
      context.lineWidth = 0.7;
      context.stroke();
      if (!lines) return;
      context.strokeStyle = "rgba(255,255,255,.28)";
      context.stroke();
    });
    this.frame(context, lines ? [90] : [30, 60, 90]);
  }

  frame(context, angles) {
    const scale = this.radius / 90;
    context.lineWidth = this.ratio;
    context.font = `${11 * this.ratio}px sans-serif`;
    for (const angle of angles) {
      context.beginPath();
      context.arc(this.centre, this.centre, angle * scale, 0, 2 * Math.PI);
      context.strokeStyle = angle === 90 ? "#1b1f24" : "rgba(255,255,255,.45)";
      context.stroke();
    }
    context.fillStyle = "#5a636e";
    context.textAlign = "center";
    context.textBaseline = "middle";
    const far = this.radius + 9 * this.ratio;
    context.fillText("up", this.centre, this.centre - far);
    context.save();
    context.translate(this.centre + far, this.centre);
    context.rotate(Math.PI / 2);
    context.fillText("right", 0, 0);
    context.restore();
  }

  empty(text) {
    this.resize();
    this.rings = null;
    const context = this.canvas.getContext("2d");
    context.fillStyle = "#f5f6f8";
    context.beginPath();
    context.arc(this.centre, this.centre, this.radius, 0, 2 * Math.PI);
    context.fill();
    context.fillStyle = "#5a636e";
    context.font = `${14 * this.ratio}px sans-serif`;
    context.textAlign = "center";
    context.fillText(text, this.centre, this.centre);
  }

  ring(patch, colour) {
    const context = this.canvas.getContext("2d");
    this.outline(context, this.rings.patches[patch]);
    context.lineWidth = 4.5 * this.ratio;
    context.strokeStyle = "rgba(0,0,0,.7)";
    context.stroke();
    context.lineWidth = 2.2 * this.ratio;
    context.strokeStyle = colour;
    context.stroke();
  }

  cross(theta, phi) {
    const [x, y] = this.place(theta, phi), size = 6 * this.ratio, context = this.canvas.getContext("2d");
    for (const [width, colour] of [[3.6, "rgba(0,0,0,.75)"], [1.6, "#5fd0ff"]]) {
      context.beginPath();
      for (const [a, b] of [[1, 1], [1, -1]]) {
        context.moveTo(x - size * a, y - size * b);
        context.lineTo(x + size * a, y + size * b);
      }
      context.lineWidth = width * this.ratio;
      context.strokeStyle = colour;
      context.stroke();
    }
  }

  // Patch at the position of a pointer event, or -1.
  at(event) {
    if (!this.rings) return -1;
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) * this.canvas.width / box.width - this.centre) * this.turned;
    const y = (this.centre - (event.clientY - box.top) * this.canvas.height / box.height) * this.turned;
    const theta = Math.hypot(x, y) / this.radius * Math.PI / 2;
    return theta < Math.PI / 2 ? this.rings.find(theta, Math.atan2(y, x)) : -1;
  }
}
