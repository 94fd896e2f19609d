// Events of the controls. Changes made at the same time are shown once.

function startControls(explorer) {
  const waiting = new Set();
  const later = (...names) => {
    if (!waiting.size) setTimeout(() => {
      const due = [...waiting];
      waiting.clear();
      for (const name of due) explorer[name]();
      fillTable(explorer);
    }, 0);
    for (const name of names) waiting.add(name);
  };
  const on = (identifier, event, act) => byId(identifier)?.addEventListener(event, act);
  const bind = (identifiers, event, ...names) => identifiers.forEach(each => on(each, event, () => later(...names)));
  bind(["date", "hour"], "input", "showMoment");
  bind(["metric"], "change", "showYear");
  bind(["hours"], "change", "showYear", "showGlare");
  bind(["from-hour", "to-hour"], "input", "showYear", "showGlare");
  bind(["dgp-limit", "direction"], "input", "showGlare");
  bind(["grid"], "change", "showMoment", "showYear");
  on("view-grid", "change", async () => {
    await loadPositions(explorer);
    later("showGlare");
  });
  for (const name of ["low", "high"]) startLimit(name, () => later("showYear"));
  const operate = async () => {
    showFields();
    byId("busy").textContent = "Reading the hours of the states …";
    await explorer.load();
    byId("busy").textContent = "";
    later("showMoment", "showYear", "showGlare");
  };
  for (const control of document.querySelectorAll("#operation select, #operation input")) {
    control.addEventListener("change", operate);
  }
  showFields();
  on("values", "toggle", () => fillTable(explorer));
}

// A number field and a slider with round numbers, for the same limit
function startLimit(name, act) {
  const field = byId(name), slider = byId(`${name}-slider`);
  const round = [];
  for (const decade of [10, 100, 1000, 10000]) {
    for (let k = 10; k < 100; k += k < 20 ? 1 : k < 50 ? 2.5 : 5) round.push(decade * k / 10);
  }
  slider.max = round.length - 1;
  const follow = () => {
    const far = value => Math.abs(Math.log(value / Math.max(+field.value, 1)));
    slider.value = round.reduce((best, value, k) => far(value) < far(round[best]) ? k : best, 0);
    slider.setAttribute("aria-valuetext", `${field.value} lux`);
  };
  slider.addEventListener("input", () => {
    field.value = round[+slider.value];
    slider.setAttribute("aria-valuetext", `${field.value} lux`);
    act();
  });
  field.addEventListener("input", () => {
    if (!(+field.value > 0)) return;
    follow();
    act();
  });
  follow();
}

// Only the fields of the chosen kind of operation
function showFields() {
  for (const side of ["a", "b"]) {
    const kind = byId(`kind-${side}`)?.value;
    for (const name of ["hand", "rule"]) {
      const field = byId(`${name}-${side}`);
      if (field) field.hidden = kind !== name;
    }
  }
}
