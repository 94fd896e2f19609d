// Floor plans: the value at the pointer, and selection of a sensor.

function showTip(event, text) {
  const tip = document.getElementById("tip");
  tip.style.display = text ? "block" : "none";
  if (!text) return;
  tip.textContent = text;
  const x = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
  tip.style.left = Math.max(4, x) + "px";
  tip.style.top = Math.max(4, event.clientY - tip.offsetHeight - 10) + "px";
}

function svgPoint(svg, event) {
  const at = new DOMPoint(event.clientX, event.clientY);
  return at.matrixTransform(svg.getScreenCTM().inverse());
}

function nearestSensor(grid, point) {
  let best = -1, least = grid.reach * grid.reach;
  for (let k = 0; k < grid.x.length; k++) {
    const far = (grid.x[k] - point.x) ** 2 + (grid.y[k] - point.y) ** 2;
    if (far < least) { least = far; best = k; }
  }
  return best;
}

function markChosen(data, sensor) {
  for (const svg of document.querySelectorAll("svg.plan[data-grid]")) {
    const grid = data.grids[svg.dataset.grid], k = grid.sensors.indexOf(sensor);
    const ring = svg.querySelector(".chosen");
    ring.setAttribute("cx", k < 0 ? -99 : grid.x[k]);
    ring.setAttribute("cy", k < 0 ? -99 : grid.y[k]);
  }
}

function startPlans(data, choose) {
  for (const svg of document.querySelectorAll("svg.plan[data-grid]")) {
    const grid = data.grids[svg.dataset.grid], metric = data.metrics[svg.dataset.metric];
    const find = event => {
      const k = nearestSensor(grid, svgPoint(svg, event));
      return k < 0 ? -1 : grid.sensors[k];
    };
    svg.addEventListener("pointermove", event => {
      const k = find(event);
      showTip(event, k < 0 ? "" : `${data.names[k]}\n${metric.texts[k]}`);
    });
    svg.addEventListener("pointerleave", event => showTip(event, ""));
    svg.addEventListener("click", event => {
      const k = find(event);
      if (k >= 0) choose(k);
    });
  }
}
