// Annual heat map of the selected series, and the value at the pointer.

async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

function fillCells(year, codes) {
  const size = year.days * year.bins, total = new Float64Array(size), count = new Uint32Array(size);
  for (let t = 0; t < codes.length; t++) {
    total[year.cells[t]] += Math.expm1(codes[t] * year.code_step);
    count[year.cells[t]] += 1;
  }
  return total.map((sum, k) => count[k] ? sum / count[k] : NaN);
}

function paintYear(year, values) {
  const canvas = document.createElement("canvas");
  canvas.width = year.days;
  canvas.height = year.bins;
  const context = canvas.getContext("2d"), image = context.createImageData(year.days, year.bins);
  const last = year.colours.length - 1, span = Math.log(year.high / year.low);
  for (let day = 0; day < year.days; day++) {
    for (let bin = 0; bin < year.bins; bin++) {
      const lux = values[day * year.bins + bin];
      if (Number.isNaN(lux)) continue;
      const share = Math.log(Math.min(Math.max(lux, year.low), year.high) / year.low) / span;
      const colour = year.colours[Math.round(share * last)];
      image.data.set([...colour, 255], 4 * ((year.bins - 1 - bin) * year.days + day));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

// Day and hour at the pointer, in any annual map
function yearCell(year, svg, event) {
  const at = svgPoint(svg, event), box = svg.dataset;
  const day = Math.floor((at.x - box.left) / box.width * year.days);
  const bin = Math.floor((1 - (at.y - box.top) / box.height) * year.bins);
  const inside = day >= 0 && day < year.days && bin >= 0 && bin < year.bins;
  return inside ? { day, bin } : null;
}

function cellWords(year, { day, bin }) {
  const date = new Date(year.dates[day] * 864e5), step = 1440 / year.bins;
  const when = date.toLocaleDateString("en-GB", { day: "numeric", month: "short", timeZone: "UTC" });
  const clock = minute => `${String(Math.floor(minute / 60)).padStart(2, "0")}:${String(minute % 60).padStart(2, "0")}`;
  return `${when}, ${clock(bin * step)}–${clock((bin + 1) * step)}`;
}

async function startYear(data, onChoose) {
  const svg = document.getElementById("heat-map"), list = document.getElementById("series");
  const year = data.year, picture = svg.querySelector("image");
  year.days = year.dates.length;
  year.cells = new Uint32Array(await unpack(year.cell));
  let shown = null, name = "";

  const show = async index => {
    const series = year.series[index];
    const codes = new Uint16Array(await unpack(series.codes));
    shown = fillCells(year, codes);
    name = series.name;
    picture.setAttribute("href", paintYear(year, shown));
    svg.setAttribute("aria-label", `${series.name}: illuminance by day and hour`);
    list.value = index;
    onChoose(series.sensor);
  };

  list.addEventListener("change", () => show(+list.value));
  svg.addEventListener("pointermove", event => {
    const place = yearCell(year, svg, event);
    if (!place) return showTip(event, "");
    const lux = shown[place.day * year.bins + place.bin];
    const value = Number.isNaN(lux) ? "no data" : `${Math.round(lux).toLocaleString("en")} lux`;
    showTip(event, `${cellWords(year, place)}\n${name}: ${value}`);
  });
  svg.addEventListener("pointerleave", event => showTip(event, ""));
  await show(0);

  // The series of the sensor, or the series on the page with the nearest number
  return sensor => {
    let best = 0, least = Infinity;
    year.series.forEach((series, index) => {
      if (series.sensor === null) return;
      const far = Math.abs(series.sensor - sensor);
      if (far < least) { least = far; best = index; }
    });
    return show(best);
  };
}
