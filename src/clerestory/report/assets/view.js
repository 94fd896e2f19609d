// 3-D view of the scene: drag to turn, buttons to zoom, walls in front hidden.

const PALE_EDGE = rgb(214, 218, 223), EDGE = rgb(120, 128, 137);
const FRONT = [47, 143, 91], BACK = [217, 119, 43], UP = [106, 61, 154], NORTH = [70, 78, 88];

class RoomView {
  constructor(stage, scene) {
    this.stage = stage;
    this.scene = scene;
    this.canvas = stage.querySelector("canvas");
    this.centre = scene.low.map((low, k) => (low + scene.high[k]) / 2);
    this.radius = Math.max(0.5, Math.hypot(...sub(scene.high, scene.low)) / 2);
    this.cutaway = true;
    this.makeFaces();
    this.solids = this.makeSolids();
    this.marks = this.makeMarks();
    this.lookFrom("inside");
    new ResizeObserver(() => this.draw()).observe(stage);
    this.listen();
  }

  makeSolids() {
    const { windows, sensors, low, high, north } = this.scene, solids = [];
    const put = (triangles, colour) => triangles.forEach(t => solids.push({ corners: t, colour }));
    const size = 0.05 * this.radius;
    for (const window of windows) {
      const length = Math.min(Math.max(0.45 * window.size, 4 * size), 9 * size);
      put(arrow(window.centre, window.normal, length, 0.14 * size), FRONT);
      put(arrow(window.centre, window.up, 0.8 * length, 0.14 * size), UP);
    }
    const count = sensors.colour.length, pin = size * Math.min(1, Math.sqrt(120 / count) + 0.25);
    for (let k = 0; k < count; k++) {
      const at = sensors.position.slice(3 * k, 3 * k + 3), axis = sensors.direction.slice(3 * k, 3 * k + 3);
      const hex = parseInt(sensors.colour[k].slice(1), 16);
      put(cone(at, axis, 1.5 * pin, 0.45 * pin, count > 1000 ? 4 : 7), [hex >> 16, hex >> 8 & 255, hex & 255]);
    }
    const towards = [-Math.sin(north), Math.cos(north), 0];
    this.compass = [high[0] + 5 * size, (low[1] + high[1]) / 2, low[2] + 0.01];
    put(arrow(add(this.compass, towards, -4 * size), towards, 8 * size, 0.12 * size), NORTH);
    this.northTip = add(this.compass, towards, 5.4 * size);
    return solids;
  }

  makeMarks() {
    const mark = (text, at, doubt = false) => {
      const span = document.createElement("span");
      span.className = doubt ? "mark doubt" : "mark";
      span.textContent = text;
      this.stage.append(span);
      return { span, at };
    };
    const size = 0.05 * this.radius, marks = [mark("N", this.northTip)];
    for (const window of this.scene.windows) {
      const length = Math.min(Math.max(0.45 * window.size, 4 * size), 9 * size);
      const tip = add(window.centre, window.normal, length + 1.6 * size);
      marks.push(mark(`front of ${window.name}${window.doubt ? ": check" : ""}`, tip, window.doubt));
      marks.push(mark("up", add(window.centre, window.up, 0.8 * length + size)));
    }
    return marks;
  }

  lookFrom(place) {
    const window = this.scene.windows[0];
    const normal = window ? window.normal : [0, 1, 0];
    const level = Math.hypot(normal[0], normal[1]) > 0.3 ? normal : [0, 1, 0];
    const outside = Math.atan2(-level[1], -level[0]);
    this.turn = { outside: outside + 0.55, inside: outside + Math.PI - 0.55, above: -Math.PI / 2 }[place];
    this.tilt = { outside: 0.5, inside: 0.5, above: 1.5 }[place];
    this.zoom = 1;
    this.draw();
  }

  eye() {
    const distance = 3.7 * this.radius / this.zoom;
    const back = [Math.cos(this.tilt) * Math.cos(this.turn), Math.cos(this.tilt) * Math.sin(this.turn), Math.sin(this.tilt)];
    const right = [-Math.sin(this.turn), Math.cos(this.turn), 0];
    return { at: add(this.centre, back, distance), back, right, up: cross(back, right) };
  }

  draw(quick = false) {
    const width = this.stage.clientWidth, height = this.stage.clientHeight;
    if (!width || !height) return;
    const sharp = quick ? 1 : 2, W = Math.round(width * sharp), H = Math.round(height * sharp);
    if (!this.raster || this.raster.width !== W || this.raster.height !== H) this.raster = new Raster(W, H);
    const raster = this.raster, eye = this.eye(), focus = 1.9 * Math.min(W * 0.8, H);
    raster.clear(rgb(255, 255, 255));

    // Camera space: right, up, distance ahead
    const lens = {
      near: 0.02 * this.radius,
      toEye: p => { const d = sub(p, eye.at); return [dot(d, eye.right), dot(d, eye.up), -dot(d, eye.back)]; },
      toScreen: p => [W / 2 + focus * p[0] / p[2], H / 2 - focus * p[1] / p[2], 1 / p[2]],
    };
    const seen = this.place(lens);
    this.paintSurfaces(raster, eye, lens, seen);
    this.paintEdges(raster, lens, seen, sharp);
    this.paintWindows(raster, eye, lens);
    for (const { corners, colour } of this.solids) this.paintSolid(raster, corners, colour, lens);
    this.show(raster, width, height);
    for (const { span, at } of this.marks) {
      const p = lens.toEye(at), s = lens.toScreen(p);
      span.style.left = 100 * s[0] / W + "%";
      span.style.top = 100 * s[1] / H + "%";
      span.hidden = p[2] < lens.near;
    }
  }

  // All vertices in camera space
  place(lens) {
    const { vertices } = this.scene, seen = [];
    for (let k = 0; k < vertices.length; k += 3) seen.push(lens.toEye([vertices[k], vertices[k + 1], vertices[k + 2]]));
    return seen;
  }

  // Plane and tone of each face; faces outside the room are pale
  makeFaces() {
    const { vertices, faces, colours, low, high } = this.scene;
    const vertex = k => [vertices[3 * k], vertices[3 * k + 1], vertices[3 * k + 2]];
    this.faces = [];
    for (let f = 0; f < faces.length; f += 3) {
      const corners = [faces[f], faces[f + 1], faces[f + 2]], [a, b, c] = corners.map(vertex);
      const normal = unit(cross(sub(b, a), sub(c, a)));
      const pale = [0, 1, 2].some(k => {
        const middle = (a[k] + b[k] + c[k]) / 3;
        return middle < low[k] - 0.05 || middle > high[k] + 0.05;
      });
      const light = 0.92 + 0.08 * Math.abs(normal[2]) - 0.05 * Math.abs(normal[0]);
      const tone = k => Math.min(255, Math.round((pale ? 240 : 200 + 0.2 * colours[f + k]) * light));
      this.faces.push({ corners, normal, offset: dot(normal, a), pale, colour: rgb(tone(0), tone(1), tone(2)), visible: true });
    }
  }

  // Faces between the eye and the middle of the room are hidden
  paintSurfaces(raster, eye, lens, seen) {
    for (const face of this.faces) {
      const facing = dot(face.normal, eye.at) - face.offset, homeward = dot(face.normal, this.centre) - face.offset;
      face.visible = !(this.cutaway && facing * homeward < 0);
      if (!face.visible) continue;
      const points = clip(face.corners.map(k => seen[k]), lens.near).map(lens.toScreen);
      raster.polygon(points, face.colour);
    }
  }

  paintEdges(raster, lens, seen, width) {
    const { edges } = this.scene;
    for (let e = 0; e < edges.length; e += 4) {
      const ends = clipLine(seen[edges[e]], seen[edges[e + 1]], lens.near);
      if (!ends) continue;
      const beside = [this.faces[edges[e + 2]], this.faces[edges[e + 3]]];
      const strong = beside.some(face => face.visible && !face.pale);
      raster.line(lens.toScreen(ends[0]), lens.toScreen(ends[1]), strong ? EDGE : PALE_EDGE, width);
    }
  }

  paintSolid(raster, corners, colour, { toEye, toScreen, near }) {
    const normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
    const light = 0.72 + 0.28 * Math.abs(dot(normal, unit([0.3, -0.5, 0.8])));
    const points = clip(corners.map(toEye), near).map(toScreen);
    raster.polygon(points, rgb(...colour.map(c => Math.round(c * light))));
  }

  paintWindows(raster, eye, { toEye, toScreen, near }) {
    for (const window of this.scene.windows) {
      const front = dot(window.normal, sub(eye.at, window.centre)) > 0;
      for (let k = 0; k < window.corners.length; k += 9) {
        const corners = [0, 3, 6].map(s => toEye(window.corners.slice(k + s, k + s + 3)));
        raster.polygon(clip(corners, near).map(toScreen), rgb(...(front ? FRONT : BACK)), 0.42);
      }
    }
  }

  show(raster, width, height) {
    const whole = document.createElement("canvas");
    whole.width = raster.width;
    whole.height = raster.height;
    whole.getContext("2d").putImageData(raster.image(), 0, 0);
    const dense = Math.min(2, devicePixelRatio || 1);
    this.canvas.width = Math.round(width * dense);
    this.canvas.height = Math.round(height * dense);
    const context = this.canvas.getContext("2d");
    context.imageSmoothingQuality = "high";
    context.drawImage(whole, 0, 0, this.canvas.width, this.canvas.height);
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = 0;
      this.draw(true);
      clearTimeout(this.settle);
      this.settle = setTimeout(() => this.draw(), 160);
    });
  }

  move(turn, tilt, zoom = 1) {
    this.turn += turn;
    this.tilt = Math.min(1.55, Math.max(-1.2, this.tilt + tilt));
    this.zoom = Math.min(12, Math.max(0.2, this.zoom * zoom));
    this.redraw();
  }

  listen() {
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", event => {
      if (!event.buttons) return;
      this.move(-event.movementX * 0.008, event.movementY * 0.008);
    });
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      this.move(0, 0, Math.exp(-event.deltaY * 0.0015));
    }, { passive: false });
    const keys = {
      ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1],
      "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15],
    };
    canvas.addEventListener("keydown", event => {
      if (!keys[event.key]) return;
      event.preventDefault();
      this.move(...keys[event.key]);
    });
    for (const button of document.querySelectorAll("[data-look]")) button.onclick = () => this.lookFrom(button.dataset.look);
    for (const button of document.querySelectorAll("[data-zoom]")) button.onclick = () => this.move(0, 0, +button.dataset.zoom);
    const box = document.getElementById("cutaway");
    box.onchange = () => { this.cutaway = box.checked; this.draw(); };
  }
}

function clip(points, near) {
  if (points.every(p => p[2] >= near)) return points;
  const kept = [];
  points.forEach((p, k) => {
    const q = points[(k + 1) % points.length];
    if (p[2] >= near) kept.push(p);
    if ((p[2] >= near) !== (q[2] >= near)) kept.push(add(p, sub(q, p), (near - p[2]) / (q[2] - p[2])));
  });
  return kept;
}

function clipLine(p, q, near) {
  if (p[2] < near && q[2] < near) return null;
  const cut = (a, b) => a[2] >= near ? a : add(a, sub(b, a), (near - a[2]) / (b[2] - a[2]));
  return [cut(p, q), cut(q, p)];
}

async function startView(scene) {
  const stage = document.getElementById("stage");
  if (!stage) return;
  scene.vertices = new Float32Array(await unpack(scene.vertices));
  scene.faces = new Uint32Array(await unpack(scene.faces));
  scene.colours = new Uint8Array(await unpack(scene.colours));
  scene.edges = new Uint32Array(await unpack(scene.edges));
  new RoomView(stage, scene);
}
