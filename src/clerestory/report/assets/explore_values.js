// Hourly values of a run: decoding, operation of the shades, metrics of every sensor.
// Values are in the order step by step, and sensor by sensor within a step.

async function partBytes(name) {
  const embedded = document.getElementById(`part-${name}`);
  const packed = embedded ? bytesOf(embedded.textContent) : await servedBytes(name);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function servedBytes(name) {
  const answer = await fetch(`part/${name}`);
  if (!answer.ok) throw new Error(`${name}: ${answer.status} ${answer.statusText}`);
  return answer.arrayBuffer();
}

function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

// Codes from their differences between places and steps, in two planes of bytes
function codesOf(planes, places) {
  const size = planes.length / 2, codes = new Uint16Array(size);
  for (let k = 0; k < size; k += places) {
    let left = 0;
    for (let j = k; j < k + places; j++) {
      const folded = planes[j] | planes[size + j] << 8;
      left += folded >>> 1 ^ -(folded & 1);
      codes[j] = k ? codes[j - places] + left : left;
    }
  }
  return codes;
}

class HourlyValues {
  constructor(facts) {
    this.facts = facts;
    this.count = facts.sensors.length;
    this.steps = facts.lit.length;
    this.lux = Float32Array.from({ length: 65536 }, (_, code) => Math.expm1(code * facts.step));
    this.parts = new Map();
    // Number of each time step among those with daylight, or -1
    this.row = new Int32Array(facts.cell.length).fill(-1);
    facts.lit.forEach((step, row) => { this.row[step] = row; });
    // Time step of each cell (day, time of day), or -1
    this.stepAt = new Int32Array(facts.dates.length * facts.bins).fill(-1);
    facts.cell.forEach((cell, step) => { this.stepAt[cell] = step; });
  }

  hour(step) {
    return (this.facts.cell[step] % this.facts.bins + 0.5) * 24 / this.facts.bins;
  }

  codes(name, places) {
    if (!this.parts.has(name)) this.parts.set(name, partBytes(name).then(bytes => codesOf(bytes, places)));
    return this.parts.get(name);
  }

  // State of each window at every time step of an operation; null: the run itself
  states(operation) {
    const { facts } = this, total = facts.cell.length;
    if (operation.kind === "operated") return null;
    return facts.windows.map((window, k) => {
      const last = window.states.length - 1, states = new Uint8Array(total);
      if (operation.kind === "all") return states.fill(Math.min(operation.state, last));
      if (operation.kind === "hand") return states.fill(operation.states[k]);
      if (!window.irradiance) return states;
      for (let t = 0; t < total; t++) states[t] = window.irradiance[t] > operation.limit ? Math.min(operation.state, last) : 0;
      return states;
    });
  }

  // Illuminance of all sensors in the steps with daylight
  async illuminance(operation) {
    const states = this.states(operation), lux = this.lux, { count } = this;
    const total = new Float32Array(this.steps * count);
    if (!states) {
      const codes = await this.codes("operated", count);
      for (let k = 0; k < total.length; k++) total[k] = lux[codes[k]];
      return total;
    }
    for (const [k, window] of states.entries()) {
      for (const state of new Set(this.facts.lit.map(step => window[step]))) {
        const codes = await this.codes(`state-${k}-${state}`, count);
        this.facts.lit.forEach((step, row) => {
          if (window[step] !== state) return;
          for (let j = row * count, end = j + count; j < end; j++) total[j] += lux[codes[j]];
        });
      }
    }
    return total;
  }

  // Rows with daylight within the hours, and the number of all steps within them
  within(hours) {
    const rows = [];
    let all = 0;
    const count = step => {
      all++;
      if (this.row[step] >= 0) rows.push(this.row[step]);
    };
    if (hours.study) this.facts.occupied.forEach(count);
    else for (let t = 0; t < this.row.length; t++) if (this.hour(t) >= hours.from && this.hour(t) < hours.to) count(t);
    return { rows, all };
  }
}

// Metric of the sensors `first` to `first + size` over the chosen hours [lux or %]
function metricValues(metric, { lux, count, first, size, chosen, low, high }) {
  const sums = metric === "mean" || metric === "continuous" ? new Float64Array(size) : new Uint32Array(size);
  for (const row of chosen.rows) {
    const start = row * count + first;
    if (metric === "autonomy") for (let j = 0; j < size; j++) sums[j] += lux[start + j] >= low ? 1 : 0;
    else if (metric === "useful") for (let j = 0; j < size; j++) sums[j] += lux[start + j] >= low && lux[start + j] < high ? 1 : 0;
    else if (metric === "continuous") for (let j = 0; j < size; j++) sums[j] += Math.min(lux[start + j] / low, 1);
    else for (let j = 0; j < size; j++) sums[j] += lux[start + j];
  }
  const factor = (metric === "mean" ? 1 : 100) / Math.max(chosen.all, 1);
  return Float64Array.from(sums, sum => sum * factor);
}

// Percentage of the chosen hours in which DGP is above a limit, by place
function exceedance(codes, places, chosen, limit) {
  const sums = new Float64Array(places);
  for (const row of chosen.rows) {
    for (let k = 0; k < places; k++) {
      const code = codes[row * places + k];
      if (code > limit && code !== 65535) sums[k]++;
    }
  }
  return sums.map(sum => 100 * sum / Math.max(chosen.all, 1));
}
