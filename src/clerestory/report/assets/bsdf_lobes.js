// Transmitted and reflected lobes in 3-D: a block per patch, whose length is the BSDF.

class LobeView {
  constructor(stage) {
    this.stage = stage;
    this.canvas = stage.querySelector("canvas");
    this.solids = [];
    this.lookFrom("side");
    this.listen();
    new ResizeObserver(() => this.draw()).observe(stage);
  }

  lookFrom(place) {
    [this.turn, this.tilt] = { side: [-0.5, 0.28], room: [-Math.PI / 2 + 0.02, 0.06], above: [-0.35, 1.25] }[place];
    this.draw();
  }

  listen() {
    let last = null;
    this.canvas.addEventListener("pointerdown", event => { last = event; this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener("pointerup", () => { last = null; });
    this.canvas.addEventListener("pointermove", event => {
      if (!last) return;
      this.turn -= (event.clientX - last.clientX) * 0.009;
      this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + (event.clientY - last.clientY) * 0.009));
      last = event;
      this.draw();
    });
  }

  // Parts: {rings, length(patch) 0…1, colour(patch) [r,g,b], side ±1}; ray: direction of the source.
  show(parts, ray) {
    this.solids = this.arrows(ray);
    for (const { rings, length, colour, side } of parts) {
      rings.patches.forEach((patch, k) => {
        const reach = length(k);
        if (reach > 0.004) this.block(patch, reach, colour(k), side);
      });
    }
    // The translucent layer is drawn last, over the blocks behind it
    this.solids.push(...this.layer());
    this.draw();
  }

  // Coordinates of the window: x right, y up, z into the room, which is -y of the view.
  point(theta, phi, reach, side) {
    const flat = reach * Math.sin(theta);
    return [flat * Math.cos(phi), -side * reach * Math.cos(theta), flat * Math.sin(phi)];
  }

  block({ low, high: rim, from, to, whole }, reach, colour, side) {
    const high = Math.min(rim, 89 * DEGREE);
    const put = (...corners) => this.solids.push({ corners, colour });
    const steps = Math.max(1, Math.ceil((to - from) * Math.max(Math.sin(high), 0.2) / (7 * DEGREE)));
    for (let k = 0; k < steps; k++) {
      const a = from + (to - from) * k / steps, b = from + (to - from) * (k + 1) / steps;
      const corner = [[low, a], [high, a], [high, b], [low, b]].map(([t, p]) => this.point(t, p, reach, side));
      put(corner[0], corner[1], corner[2]);
      if (low > 0) put(corner[0], corner[2], corner[3]);
      const o = [0, 0, 0];
      put(o, corner[1], corner[2]);
      if (low > 0) put(o, corner[0], corner[3]);
      if (k === 0 && !whole) put(o, corner[0], corner[1]);
      if (k === steps - 1 && !whole) put(o, corner[3], corner[2]);
    }
  }

  layer() {
    const quads = [], n = 8, s = 0.92;
    for (let i = 0; i < n; i++) {
      for (let k = 0; k < n; k++) {
        const [x, X] = [i, i + 1].map(v => s * (2 * v / n - 1)), [z, Z] = [k, k + 1].map(v => s * (2 * v / n - 1));
        const colour = (i + k) % 2 ? [205, 216, 226] : [218, 227, 235];
        quads.push({ corners: [[x, 0, z], [X, 0, z], [X, 0, Z]], colour, flat: true, alpha: 0.55 });
        quads.push({ corners: [[x, 0, z], [X, 0, Z], [x, 0, Z]], colour, flat: true, alpha: 0.55 });
      }
    }
    return quads;
  }

  arrows(ray) {
    const tail = ray.map(v => 1.2 * v), inward = ray.map(v => -v);
    return arrow(tail, inward, 1.12, 0.014).map(corners => ({ corners, colour: [233, 163, 25], flat: true }))
      .concat(arrow([0.92, 0, -0.92], [0, 0, 1], 0.4, 0.009).map(corners => ({ corners, colour: [106, 61, 154], flat: true })));
  }

  draw() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.round(this.stage.clientWidth * ratio), height = Math.round(this.stage.clientHeight * ratio);
    if (!width || !height) return;
    this.canvas.width = width;
    this.canvas.height = height;
    const raster = new Raster(width, height), distance = 5.2, focus = 2.05 * Math.min(height, 0.85 * width);
    raster.clear(rgb(255, 255, 255));
    const back = [Math.cos(this.tilt) * Math.cos(this.turn), Math.cos(this.tilt) * Math.sin(this.turn), Math.sin(this.tilt)];
    const right = [-Math.sin(this.turn), Math.cos(this.turn), 0], up = cross(back, right);
    const seen = p => {
      const depth = 1 / (distance - dot(p, back));
      return [width / 2 + focus * dot(p, right) * depth, height / 2 - focus * dot(p, up) * depth, depth];
    };
    const light = unit(add(add(back, right, -0.5), up, 0.7));
    for (const { corners, colour, flat, alpha = 1 } of this.solids) {
      const normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
      const shade = flat ? 1 : 0.62 + 0.38 * Math.abs(dot(normal, light));
      raster.triangle(...corners.map(seen), rgb(...colour.map(c => Math.round(c * shade))), alpha);
    }
    const context = this.canvas.getContext("2d");
    context.putImageData(raster.image(), 0, 0);
    context.font = `${12.5 * ratio}px sans-serif`;
    context.fillStyle = "#5a636e";
    context.textAlign = "center";
    for (const [text, at] of [["room", [0, -1.15, -0.9]], ["outside", [0, 1.15, -0.9]], ["up", [0.92, 0, -0.42]]]) {
      const [x, y] = seen(at);
      context.fillText(text, x, y);
    }
  }
}
