// Controls of the page: every change recomputes what is shown from the hourly values.

const byId = identifier => document.getElementById(identifier);
const DIFFERENCE = "difference";

let explorer = null;

class Explorer {
  constructor(facts) {
    this.facts = facts;
    this.values = new HourlyValues(facts);
    this.lux = {};
    const { colours } = facts;
    this.scales = {
      lux: new Scale(colours.lux, 10, 30000, { logarithmic: true, unit: "lux", levels: [10, 100, 1000, 10000] }),
      "%": new Scale(colours.percent, 0, 100, { unit: "%", levels: [0, 20, 40, 60, 80, 100] }),
    };
    this.moment = new PlanMap(byId("moment-plan"), k => this.sensor(k));
    this.year = new PlanMap(byId("year-plan"), k => this.sensor(k));
    this.positions = facts.view_plans.length ? new PlanMap(byId("position-plan"), k => `Position ${k + 1}`) : null;
  }

  get grid() { return +byId("grid").value; }
  get plan() { return this.facts.plans[this.grid]; }
  get first() { return this.facts.plans.slice(0, this.grid).reduce((sum, plan) => sum + plan.count, 0); }
  get compared() { return byId("shown")?.value ?? "a"; }
  get step() { return this.values.stepAt[+byId("date").value * this.facts.bins + +byId("hour").value]; }
  get hours() {
    return { study: byId("hours").value === "study", from: +byId("from-hour").value, to: +byId("to-hour").value };
  }

  sensor(k) { return this.facts.sensors[this.first + k]; }

  operation(side) {
    const kind = byId(`kind-${side}`)?.value ?? "operated", [name, state] = kind.split(":");
    return {
      kind: name,
      state: name === "rule" ? +byId(`rule-state-${side}`).value : +state,
      limit: +byId(`rule-limit-${side}`)?.value,
      states: this.facts.windows.map((_, k) => +byId(`hand-${side}-${k}`)?.value),
    };
  }

  operationWords(side) {
    const list = byId(`kind-${side}`);
    if (!list) return "as operated";
    const given = this.operation(side), names = this.facts.windows.map(window => window.states);
    if (given.kind === "hand") return given.states.map((state, k) => `${this.facts.windows[k].name} ${names[k][state]}`).join(", ");
    if (given.kind === "rule") return `${byId(`rule-state-${side}`).selectedOptions[0].text} above ${given.limit} W/m²`;
    return list.selectedOptions[0].text;
  }

  get sides() { return this.compared === DIFFERENCE ? ["a", "b"] : [this.compared]; }
  get prefix() { return this.compared === DIFFERENCE ? "Difference, B less A. " : ""; }

  get comparedWords() {
    if (this.compared === DIFFERENCE) return `${this.operationWords("b")} less ${this.operationWords("a")}`;
    return this.operationWords(this.compared);
  }

  // Illuminance and DGP of the operations that are shown
  async load() {
    for (const side of this.sides) {
      const operation = this.operation(side), key = JSON.stringify(operation);
      if (this.lux[side]?.key === key) continue;
      const values = await this.values.illuminance(operation);
      this.lux[side] = { key, values, dgp: await glareCodes(this, operation) };
    }
  }

  // Values of operation A or B, or their difference
  compare(valuesOf) {
    if (this.compared !== DIFFERENCE) return valuesOf(this.lux[this.compared].values, this.compared);
    const a = valuesOf(this.lux.a.values, "a");
    return valuesOf(this.lux.b.values, "b").map((value, k) => value - a[k]);
  }

  scale(values, unit) {
    return this.compared === DIFFERENCE ? differenceScale(this.facts.colours.difference, values, unit) : this.scales[unit];
  }

  showMoment() {
    const { step, first, plan, values } = this, row = step < 0 ? -1 : values.row[step];
    const lux = this.compare(all => {
      if (step < 0) return new Float64Array(plan.count).fill(NaN);
      if (row < 0) return new Float64Array(plan.count);
      return Float64Array.from(all.subarray(row * values.count + first, row * values.count + first + plan.count));
    });
    const when = this.momentWords(), label = `Illuminance of ${plan.name}, ${when}, ${this.comparedWords}`;
    this.moment.show(plan, `plan-${this.grid}-drawing`);
    this.moment.draw(lux, this.scale(lux, "lux"), label);
    byId("date").setAttribute("aria-valuetext", this.dateWords());
    byId("hour").setAttribute("aria-valuetext", this.clock());
    byId("date-words").textContent = this.dateWords();
    byId("hour-words").textContent = this.clock();
    const mean = lux.reduce((sum, value) => sum + value, 0) / lux.length;
    const words = step < 0 ? "no data" : `${this.moment.scale.words(mean)} on average`;
    byId("moment-words").textContent = `${this.prefix}${when}: ${words}. ${this.momentNotes(step, row)}`;
    this.shownMoment = { title: label, unit: "lux", values: lux };
    showPictures(this.facts, step);
  }

  momentNotes(step, row) {
    if (step < 0) return "";
    const notes = [];
    for (const side of this.sides) {
      const states = this.values.states(this.operation(side));
      const found = this.facts.windows.flatMap((window, k) => {
        const state = states ? states[k][step] : window.operated?.[step];
        return window.states.length > 1 ? [`${window.name} ${window.states[state]}`] : [];
      });
      if (found.length) notes.push(`Windows ${this.operationWords(side)}: ${found.join(", ")}.`);
      notes.push(glareAt(this, side, row));
    }
    return notes.filter(Boolean).join(" ");
  }

  showYear() {
    const start = performance.now(), { first, plan, values } = this, chosen = values.within(this.hours);
    const metric = byId("metric").value, low = +byId("low").value, high = +byId("high").value;
    const given = { count: values.count, first, size: plan.count, chosen, low, high };
    const found = this.compare(lux => metricValues(metric, { ...given, lux }));
    const unit = metric === "mean" ? "lux" : "%", name = this.metricWords(metric, low, high);
    const label = `${name} of ${plan.name}, ${this.hourWords()}, ${this.comparedWords}`;
    this.year.show(plan, `plan-${this.grid}-drawing`);
    this.year.draw(found, this.scale(found, unit), label);
    const mean = found.reduce((sum, value) => sum + value, 0) / found.length;
    const half = 100 * found.filter(value => value >= 50).length / found.length;
    const share = unit === "%" && this.compared !== DIFFERENCE ? `; 50 % or more at ${half.toFixed(1)} % of the sensors` : "";
    byId("year-words").textContent = `${this.prefix}${name}: ${this.year.scale.words(mean)} on average${share}; ${this.hourWords()}, ${chosen.all.toLocaleString("en")} steps.`;
    byId("high-field").hidden = metric !== "useful";
    byId("low-field").hidden = metric === "mean";
    byId("own-hours").hidden = this.hours.study;
    this.shownYear = { title: label, unit, values: found };
    document.documentElement.dataset.milliseconds = (performance.now() - start).toFixed(1);
  }

  showGlare() {
    if (byId("dgp-limit")) showGlare(this);
  }

  metricWords(metric, low, high) {
    const lux = value => `${value.toLocaleString("en")} lux`;
    return {
      autonomy: `Hours with ${lux(low)} or more`,
      useful: `Hours with ${lux(low)} to ${lux(high)}`,
      continuous: `Continuous autonomy for ${lux(low)}`,
      mean: "Mean illuminance",
    }[metric];
  }

  hourWords() {
    const { study, from, to } = this.hours;
    return study ? "occupied hours of the study" : `from ${clockWords(60 * from)} to ${clockWords(60 * to)}`;
  }

  dateWords() {
    const date = new Date(this.facts.dates[+byId("date").value] * 864e5);
    return date.toLocaleDateString("en-GB", { day: "numeric", month: "long", timeZone: "UTC" });
  }

  clock() { return clockWords((+byId("hour").value + 0.5) * 1440 / this.facts.bins); }
  momentWords() { return `${this.dateWords()} ${this.clock()}`; }
}

function clockWords(minutes) {
  return `${String(Math.floor(minutes / 60)).padStart(2, "0")}:${String(Math.floor(minutes % 60)).padStart(2, "0")}`;
}

// The picture of each view at a step, or the one nearest in time
function showPictures(facts, step) {
  facts.pictures.forEach((view, k) => {
    const figure = byId(`picture-${k}`), image = figure.querySelector("img");
    const far = frame => Math.abs(frame.step - step);
    const best = view.frames.reduce((near, frame) => far(frame) < far(near) ? frame : near);
    if (image.getAttribute("src") !== best.address) image.src = best.address;
    image.alt = `${view.view}, ${best.time}`;
    figure.querySelector(".said").textContent = best.step === step ? best.time : `nearest picture: ${best.time}`;
    figure.classList.toggle("missing", best.step !== step);
  });
}

async function start() {
  const facts = JSON.parse(byId("data").textContent), root = document.documentElement;
  explorer = new Explorer(facts);
  await explorer.load();
  await loadPositions(explorer);
  root.classList.add("scripted");
  startControls(explorer);
  startFiles(explorer);
  explorer.showMoment();
  explorer.showYear();
  explorer.showGlare();
  root.dataset.opened = performance.now().toFixed(0);
  root.dataset.scripts = "done";
}

addEventListener("error", event => { document.documentElement.dataset.error = event.message; });
addEventListener("unhandledrejection", event => {
  document.documentElement.dataset.error = String(event.reason);
  const words = byId("year-words");
  if (words) words.textContent = `The values could not be read: ${event.reason}`;
});
start();
