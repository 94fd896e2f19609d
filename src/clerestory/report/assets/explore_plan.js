// False-colour plans on a canvas below the drawing of the walls, with a legend.

class Scale {
  constructor(colours, low, high, { logarithmic = false, unit = "", levels }) {
    Object.assign(this, { colours, low, high, logarithmic, unit, levels });
  }

  place(value) {
    const share = this.logarithmic
      ? Math.log(Math.max(value, this.low) / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return Math.min(Math.max(share, 0), 1);
  }

  // Number of the colour of a value
  step(value) { return Math.round(this.place(value) * (this.colours.length - 1)); }

  words(value) {
    if (Number.isNaN(value)) return "no data";
    const digits = this.unit === "%" ? 1 : Math.abs(value) < 10 ? 1 : 0;
    return `${value.toLocaleString("en", { minimumFractionDigits: digits, maximumFractionDigits: digits })} ${this.unit}`;
  }

  paint(context, x, y, width) {
    this.colours.forEach((colour, k) => {
      context.fillStyle = `rgb(${colour})`;
      context.fillRect(x + k * width / this.colours.length, y, width / this.colours.length + 1, 8);
    });
    context.fillStyle = "#5a636e";
    context.font = "11px sans-serif";
    context.textAlign = "center";
    for (const level of this.levels) {
      context.fillText(level.toLocaleString("en"), x + this.place(level) * width, y + 22);
    }
    context.textAlign = "left";
    context.fillText(this.unit, x + width + 6, y + 9);
  }
}

// Symmetric scale around zero that contains all values
function differenceScale(colours, values, unit) {
  const largest = values.reduce((most, value) => Math.max(most, Math.abs(value) || 0), 0);
  const steps = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 1e4, 2e4, 5e4, 1e5, 2e5];
  const top = steps.find(step => step >= largest) ?? largest;
  return new Scale(colours, -top, top, { unit, levels: [-top, 0, top] });
}

class PlanMap {
  constructor(holder, say) {
    this.holder = holder;
    this.canvas = holder.querySelector(".values");
    this.legend = holder.querySelector(".legend");
    this.drawing = holder.querySelector(".drawing");
    holder.addEventListener("pointermove", event => this.point(event, say));
    holder.addEventListener("pointerleave", event => showTip(event, ""));
  }

  show(plan, template) {
    if (this.plan === plan) return;
    this.plan = plan;
    this.drawing.replaceChildren(document.getElementById(template).content.cloneNode(true));
    this.svg = this.drawing.querySelector("svg.plan");
    const [width, height] = plan.size;
    this.holder.style.setProperty("--shape", `${width} / ${height}`);
    this.canvas.width = 2 * width;
    this.canvas.height = 2 * height;
  }

  draw(values, scale, label) {
    this.values = values;
    this.scale = scale;
    this.svg.setAttribute("aria-label", label);
    this.svg.querySelector("title").textContent = label;
    const context = this.canvas.getContext("2d");
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.paint(context);
    this.legend.width = 680;
    this.legend.height = 60;
    const legend = this.legend.getContext("2d");
    legend.scale(2, 2);
    scale.paint(legend, 20, 2, 280);
  }

  // One path per colour: painting cell by cell takes several times as long
  paint(context) {
    const { cells, level } = this.plan, paths = new Map();
    this.values.forEach((value, k) => {
      if (Number.isNaN(value)) return;
      const step = this.scale.step(value), cell = cells[k];
      if (!paths.has(step)) paths.set(step, new Path2D());
      const path = paths.get(step);
      path.moveTo(cell[0], cell[1]);
      for (let j = 2; j < cell.length; j += 2) path.lineTo(cell[j], cell[j + 1]);
      path.closePath();
    });
    context.lineWidth = 0.6;
    for (const [step, path] of paths) {
      context.fillStyle = `rgb(${this.scale.colours[step]})`;
      context.strokeStyle = level ? context.fillStyle : "#1b1f24";
      context.fill(path);
      context.stroke(path);
    }
  }

  point(event, say) {
    if (!this.values) return;
    const at = svgPoint(this.svg, event), points = this.plan.points;
    let best = -1, least = 30 ** 2;
    points.forEach(([x, y], k) => {
      const far = (x - at.x) ** 2 + (y - at.y) ** 2;
      if (far < least) { least = far; best = k; }
    });
    showTip(event, best < 0 ? "" : `${say(best)}\n${this.scale.words(this.values[best])}`);
  }

  // Picture of the plan with its title and legend
  async picture(lines) {
    const [width, height] = this.plan.size, zoom = 3, head = 18 * lines.length + 10;
    const canvas = document.createElement("canvas");
    const wide = Math.max(width, 380);
    canvas.width = zoom * wide;
    canvas.height = zoom * (head + height + 36);
    const context = canvas.getContext("2d");
    context.scale(zoom, zoom);
    context.fillStyle = "#fff";
    context.fillRect(0, 0, wide, canvas.height);
    context.fillStyle = "#1b1f24";
    lines.forEach((line, k) => {
      context.font = k ? "11px sans-serif" : "bold 13px sans-serif";
      context.fillText(line, 10, 18 + 18 * k, wide - 20);
    });
    context.translate(0, head);
    this.paint(context);
    context.drawImage(await this.walls(), 0, 0, width, height);
    this.scale.paint(context, 20, height + 2, 280);
    return new Promise(done => { canvas.toBlob(done, "image/png"); });
  }

  async walls() {
    const svg = this.svg.cloneNode(true), [width, height] = this.plan.size;
    const style = document.createElementNS("http://www.w3.org/2000/svg", "style");
    style.textContent = document.getElementById("plan-style").textContent;
    for (const use of svg.querySelectorAll("use")) {
      const path = document.querySelector(use.getAttribute("href")).cloneNode(true);
      path.setAttribute("class", use.getAttribute("class"));
      use.replaceWith(path);
    }
    svg.prepend(style);
    svg.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    svg.setAttribute("width", 3 * width);
    svg.setAttribute("height", 3 * height);
    const image = new Image(), text = new XMLSerializer().serializeToString(svg);
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
    await image.decode();
    return image;
  }
}
