// Interactive view of a BSDF: scattering for a chosen incident direction.

class BsdfView {
  constructor(functions, colours) {
    this.functions = functions;
    this.colours = colours;
    this.incident = new Disc(document.getElementById("incident"), true);
    this.discs = { transmission: new Disc(document.getElementById("transmission")), reflection: new Disc(document.getElementById("reflection")) };
    this.lobes = new LobeView(document.getElementById("lobes"));
    this.fillControls();
    this.patch = 0;
    this.startPatch();
    this.listen();
    this.draw();
  }

  fillControls() {
    const channels = [...new Set(this.functions.map(f => f.channel))], select = document.getElementById("channel");
    channels.forEach(name => select.append(new Option(name, name)));
    const sides = new Set(this.functions.map(f => f.name.split("_")[1]));
    for (const input of document.querySelectorAll("[name=side]")) {
      input.disabled = !sides.has(input.value);
      input.checked = input.value === (sides.has("front") ? "front" : "back");
    }
  }

  chosen(name) { return document.querySelector(`[name=${name}]:checked`).value; }
  part(kind) {
    const name = `${kind}_${this.chosen("side")}`, channel = document.getElementById("channel").value;
    return this.functions.find(f => f.channel === channel && f.name === name);
  }
  // Whether the light of a function leaves into the room.
  toRoom(kind) { return (kind === "transmission") === (this.chosen("side") === "front"); }

  // An incident patch is numbered by the undeviated direction. The source is opposite:
  // in front of the layer in all coordinates, in the room in x and y.
  startPatch() {
    const part = this.part("transmission") || this.part("reflection");
    this.patch = part ? part.incidents.find(40 * DEGREE, -90 * DEGREE) : 0;
  }

  value(part, k) {
    const code = part.codes[this.patch * part.exits.size + k];
    return code ? part.high * Math.exp((code - 65535) * part.step) : 0;
  }

  top() {
    let top = 0;
    for (const kind of ["transmission", "reflection"]) {
      const part = this.part(kind);
      if (part) for (let k = 0; k < part.exits.size; k++) top = Math.max(top, this.value(part, k));
    }
    // Layers that scatter less are drawn dark, as opaque
    return Math.max(top, 1e-3);
  }

  fraction(value, top) {
    if (this.chosen("scale") === "linear") return value / top;
    return value > 0 ? Math.max(0, 1 + Math.log10(value / top) / 4) : 0;
  }

  colour(t) { return this.colours[Math.round(Math.min(1, Math.max(0, t)) * (this.colours.length - 1))]; }
  css(t) { return `rgb(${this.colour(t).join()})`; }

  draw() {
    const parts = [], top = this.top(), some = this.part("transmission") || this.part("reflection");
    if (!some) return this.drawNothing();
    this.patch = Math.min(this.patch, some.incidents.size - 1);
    const shares = this.shares(), most = Math.max(1e-9, ...shares), grey = share => 40 + 205 * share / most;
    this.incident.draw(some.incidents, k => `rgb(${[0.78, 0.92, 1].map(c => Math.round(c * grey(shares[k]))).join()})`, true);
    this.incident.ring(this.patch, "#ffb000");
    const [theta, phi] = some.incidents.middle(this.patch);
    document.getElementById("incident-words").textContent = this.sourceWords(theta, phi);
    document.getElementById("incident-legend").textContent =
      `brightness: direct-hemispherical value, 0 to ${most.toFixed(3)}`;
    for (const [kind, disc] of Object.entries(this.discs)) {
      const part = this.part(kind), words = document.getElementById(`${kind}-words`);
      if (!part) {
        disc.empty("not in this file");
        words.textContent = "\u00a0";
        continue;
      }
      disc.draw(part.exits, k => this.css(this.fraction(this.value(part, k), top)), part.exits.size < 500);
      disc.cross(theta, phi);
      words.textContent = `${part.share[this.patch].toFixed(4)} of the light; ${part.diffuse.toFixed(4)} of diffuse light`;
      parts.push({
        rings: part.exits, side: this.toRoom(kind) ? 1 : -1,
        length: k => this.fraction(this.value(part, k), top),
        colour: k => this.colour(0.12 + 0.88 * this.fraction(this.value(part, k), top)),
      });
    }
    this.drawLegend(top);
    const source = this.lobes.point(theta, phi + Math.PI, 1, this.chosen("side") === "front" ? -1 : 1);
    this.lobes.show(parts, source);
    document.getElementById("lobe-words").textContent =
      `length of the blocks: ${this.chosen("scale") === "log" ? "logarithm of the" : "the"} BSDF; orange line: incident light; drag to turn`;
  }

  drawNothing() {
    for (const disc of [this.incident, ...Object.values(this.discs)]) disc.empty("not in this file");
    this.lobes.show([], [0, 1, 0]);
  }

  shares() {
    const parts = ["transmission", "reflection"].map(kind => this.part(kind)).filter(Boolean);
    const shown = this.part("transmission") || parts[0];
    return shown.share;
  }

  sourceWords(theta, phi) {
    const degrees = (phi / DEGREE + 180 + 720) % 360, from = theta / DEGREE;
    const place = from < 0.5 ? "along the normal" : `${from.toFixed(0)}° off the normal, azimuth ${degrees.toFixed(0)}°`;
    return `${place} (patch ${this.patch})`;
  }

  drawLegend(top) {
    const canvas = document.getElementById("legend"), ratio = devicePixelRatio || 1;
    const width = canvas.width = Math.round(canvas.clientWidth * ratio), height = canvas.height = 46 * ratio;
    const context = canvas.getContext("2d"), left = 24 * ratio, right = width - 24 * ratio, log = this.chosen("scale") === "log";
    for (let x = left; x < right; x++) {
      context.fillStyle = this.css((x - left) / (right - left));
      context.fillRect(x, 4 * ratio, 1.5, 12 * ratio);
    }
    context.fillStyle = "#5a636e";
    context.font = `${12 * ratio}px sans-serif`;
    context.textAlign = "center";
    for (let k = 0; k <= 4; k++) {
      const value = log ? top * 10 ** (k - 4) : top * k / 4;
      context.fillText(value.toPrecision(2).replace(/e([+-])/, "·10^$1"), left + (right - left) * k / 4, 30 * ratio);
    }
    context.fillText("1/sr", (left + right) / 2, 43 * ratio);
  }

  listen() {
    const choose = patch => {
      if (patch < 0) return;
      this.patch = patch;
      this.draw();
    };
    const canvas = this.incident.canvas;
    canvas.addEventListener("click", event => choose(this.incident.at(event)));
    canvas.addEventListener("keydown", event => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key], rings = this.incident.rings;
      const across = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!(step || across) || !rings) return;
      event.preventDefault();
      if (step) return choose((this.patch + step + rings.size) % rings.size);
      const { ring } = rings.patches[this.patch], next = ring + across;
      if (next < 0 || next >= rings.count.length) return;
      choose(rings.find((rings.theta[next] + rings.theta[next + 1]) / 2, rings.middle(this.patch)[1]));
    });
    document.getElementById("controls").addEventListener("change", () => this.draw());
    document.querySelectorAll("[data-look]").forEach(button => button.addEventListener("click", () => this.lobes.lookFrom(button.dataset.look)));
    addEventListener("resize", () => this.draw());
    this.explain();
  }

  explain() {
    const tip = document.getElementById("tip");
    const show = (event, text) => {
      tip.style.display = text ? "block" : "none";
      tip.textContent = text;
      tip.style.left = `${Math.min(event.clientX + 14, innerWidth - 230)}px`;
      tip.style.top = `${event.clientY + 16}px`;
    };
    const follow = (disc, words) => {
      disc.canvas.addEventListener("pointermove", event => { const k = disc.at(event); show(event, k < 0 ? "" : words(k)); });
      disc.canvas.addEventListener("pointerleave", event => show(event, ""));
    };
    follow(this.incident, k => {
      const kinds = ["transmission", "reflection"].filter(kind => this.part(kind));
      return [`patch ${k}`, ...kinds.map(kind => `${kind} ${this.part(kind).share[k].toFixed(4)}`)].join("\n");
    });
    for (const [kind, disc] of Object.entries(this.discs)) {
      follow(disc, k => {
        const [theta, phi] = disc.rings.middle(k);
        return `${this.value(this.part(kind), k).toPrecision(4)} /sr\npatch ${k}: ${(theta / DEGREE).toFixed(0)}°, azimuth ${((phi / DEGREE + 360) % 360).toFixed(0)}°`;
      });
    }
  }
}

async function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  for (const part of data.functions) {
    part.exits = new Rings(part.exits);
    part.incidents = new Rings(part.incidents);
    part.codes = new Uint16Array(await unpack(part.codes));
  }
  document.documentElement.classList.add("scripted");
  globalThis.view = new BsdfView(data.functions, data.colours);
  document.documentElement.dataset.scripts = "done";
}

addEventListener("error", event => { document.documentElement.dataset.error = event.message; });
addEventListener("unhandledrejection", event => { document.documentElement.dataset.error = String(event.reason); });
start();
