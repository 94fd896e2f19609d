// Rosettes of view grids: choice of a position and direction, and the year of this view.

function sectorAt(level, point) {
  let best = -1, least = level.radius * level.radius * 1.1;
  for (let k = 0; k < level.x.length; k++) {
    const far = (level.x[k] - point.x) ** 2 + (level.y[k] - point.y) ** 2;
    if (far < least) { least = far; best = k; }
  }
  if (best < 0) return null;
  const turn = Math.atan2(point.x - level.x[best], level.y[best] - point.y);
  const apart = level.azimuth.map(azimuth => Math.cos(azimuth - turn));
  return { position: level.members[best], direction: apart.indexOf(Math.max(...apart)) };
}

// Outline of the sector of a view direction, with its position
function sectorOutline(level, k, direction) {
  const half = Math.PI / Math.max(level.azimuth.length, 3), r = level.radius + 1.5;
  const ends = [-half, half].map(turn => {
    const azimuth = level.azimuth[direction] + turn;
    return [level.x[k] + r * Math.sin(azimuth), level.y[k] - r * Math.cos(azimuth)];
  });
  const [start, end] = ends.map(at => at.map(x => x.toFixed(1)).join(","));
  const large = half > Math.PI / 2 ? 1 : 0;
  return `M${level.x[k]},${level.y[k]}L${start}A${r},${r} 0 ${large} 1 ${end}Z`;
}

function paintGlare(year, colours, cells) {
  const canvas = document.createElement("canvas");
  canvas.width = year.days;
  canvas.height = year.bins;
  const context = canvas.getContext("2d"), image = context.createImageData(year.days, year.bins);
  cells.forEach((code, k) => {
    if (code >= colours.length) return;
    const row = year.bins - 1 - k % year.bins, day = Math.floor(k / year.bins);
    image.data.set([...colours[code], 255], 4 * (row * year.days + day));
  });
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

async function startViewGrid(data, grid) {
  const find = part => document.getElementById(`${grid.identifier}-${part}`);
  const place = find("position"), facing = find("direction"), svg = find("year");
  const said = document.querySelector(`#${grid.identifier} .chosen-view`);
  const codes = new Uint8Array(await unpack(grid.codes)), year = data.year;
  const size = year.days * year.bins;
  const plans = grid.levels.flatMap(level =>
    [...document.querySelectorAll(`svg[data-rosettes="${level.plan}"]`)].map(plan => ({ level, plan })));
  let cells = codes, title = "";

  const show = (position, direction) => {
    const view = position * grid.directions + direction;
    place.value = position;
    facing.value = direction;
    cells = codes.subarray(view * size, (view + 1) * size);
    svg.querySelector("image").setAttribute("href", paintGlare(year, data.rosettes.colours, cells));
    title = `Position ${place.selectedOptions[0].text}, ${facing.selectedOptions[0].text}`;
    said.textContent = `${title}: ${grid.texts[view]}`;
    svg.setAttribute("aria-label", `${title}: glare by day and hour`);
    for (const { level, plan } of plans) {
      const k = level.members.indexOf(position);
      plan.querySelector(".pointed").setAttribute("d", k < 0 ? "" : sectorOutline(level, k, direction));
    }
  };

  for (const { level, plan } of plans) {
    plan.addEventListener("pointermove", event => {
      const at = sectorAt(level, svgPoint(plan, event));
      if (!at) return showTip(event, "");
      const where = `${place.options[at.position].text}\n${facing.options[at.direction].text}`;
      showTip(event, `Position ${where}\n${grid.texts[at.position * grid.directions + at.direction].split(":")[0]}`);
    });
    plan.addEventListener("pointerleave", event => showTip(event, ""));
    plan.addEventListener("click", event => {
      const at = sectorAt(level, svgPoint(plan, event));
      if (at) show(at.position, at.direction);
    });
  }
  for (const list of [place, facing]) list.addEventListener("change", () => show(+place.value, +facing.value));
  find("worst").addEventListener("click", () => show(...grid.worst));
  const tell = event => {
    const at = yearCell(year, svg, event);
    if (!at) return showTip(event, "");
    const code = cells[at.day * year.bins + at.bin];
    showTip(event, `${cellWords(year, at)}\n${code > 100 ? "no daylight" : `DGP ${(code / 100).toFixed(2)}`}`);
  };
  svg.addEventListener("pointermove", tell);
  svg.addEventListener("pointerdown", tell);
  svg.addEventListener("pointerleave", event => showTip(event, ""));
  show(...grid.worst);
}

async function startRosettes(data) {
  if (!data.rosettes) return;
  for (const grid of data.rosettes.grids) await startViewGrid(data, grid);
}
