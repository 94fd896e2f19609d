// Terms of the matrix equation for the selected sensor and day.

function axisTop(steps, most) {
  for (let decade = 1; decade < 1e6; decade *= 10) {
    const step = steps.find(m => 4 * m * decade >= most);
    if (step) return 4 * step * decade;
  }
  return 1e6;
}

async function startTerms(terms) {
  if (!terms) return;
  const list = document.getElementById("term-sensor"), words = document.getElementById("term-day");
  const levels = document.getElementById("term-levels").children, lines = document.getElementById("term-lines").children;
  const chart = document.getElementById("term-chart"), [width, height, left, top] = terms.box;
  const days = new Int32Array(await unpack(terms.day)), minutes = new Uint16Array(await unpack(terms.minute));
  const dates = [...new Set(days)];
  let codes = null, day = terms.start, scale = 1, steps = [];

  const value = (line, step) => Math.expm1(codes[line * days.length + step] * terms.code_step);
  const draw = () => {
    steps = [...days.keys()].filter(step => days[step] === day);
    scale = axisTop(terms.steps, Math.max(4, ...steps.flatMap(step => [0, 1, 2, 3].map(line => value(line, step)))));
    for (let k = 0; k < 5; k++) levels[k].textContent = (scale * k / 4).toLocaleString("en");
    for (let line = 0; line < 4; line++) {
      const points = steps.map(step => {
        const x = left + width * minutes[step] / 1440, y = top + height * (1 - value(line, step) / scale);
        return `${x.toFixed(1)},${y.toFixed(1)}`;
      });
      lines[line].setAttribute("d", "M" + points.join("L"));
    }
    words.textContent = new Date(day * 864e5).toLocaleDateString("en-GB", { day: "numeric", month: "long", timeZone: "UTC" });
  };
  const choose = async index => {
    codes = new Uint16Array(await unpack(terms.series[index].codes));
    draw();
  };

  list.addEventListener("change", () => choose(+list.value));
  for (const button of document.querySelectorAll("#equation [data-step]")) {
    button.addEventListener("click", () => {
      const place = dates.indexOf(day) + +button.dataset.step;
      day = dates[(place + dates.length) % dates.length];
      draw();
    });
  }
  chart.addEventListener("pointermove", event => {
    const minute = (svgPoint(chart, event).x - left) / width * 1440;
    const near = steps.reduce((a, b) => Math.abs(minutes[b] - minute) < Math.abs(minutes[a] - minute) ? b : a, steps[0]);
    if (minute < 0 || minute > 1440) return showTip(event, "");
    const [whole, spread, sun, sum] = [0, 1, 2, 3].map(line => Math.round(value(line, near)).toLocaleString("en"));
    const clock = `${String(Math.floor(minutes[near] / 60)).padStart(2, "0")}:${String(minutes[near] % 60).padStart(2, "0")}`;
    showTip(event, `${clock}\n${whole} − ${spread} + ${sun} = ${sum} lux`);
  });
  chart.addEventListener("pointerleave", event => showTip(event, ""));
  await choose(0);
}
