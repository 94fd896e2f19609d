// Glare of views under the operations that are shown, and of the positions of view grids.

// Codes of DGP of all views by step with daylight; null where it was not computed
async function glareCodes({ facts, values }, operation) {
  const count = facts.views.length, states = values.states(operation);
  if (!count) return null;
  if (!states) return values.codes("views", count);
  const last = facts.windows.map(window => window.states.length - 1);
  const common = facts.lit.map(step => {
    const most = Math.max(...states.map(window => window[step]));
    return states.every((window, k) => window[step] === Math.min(most, last[k])) ? most : -1;
  });
  if (!facts.glare_states || common.includes(-1)) return null;
  const codes = new Uint16Array(facts.lit.length * count);
  for (const state of new Set(common)) {
    const own = await values.codes(`views-${state}`, count);
    common.forEach((each, row) => {
      if (each === state) codes.set(own.subarray(row * count, (row + 1) * count), row * count);
    });
  }
  return codes;
}

// DGP of each view at a row of an operation, in words; "" if there is none
function glareAt(explorer, side, row) {
  const { facts } = explorer, dgp = explorer.lux[side].dgp;
  if (!dgp || row < 0) return "";
  const shown = facts.views.flatMap((view, k) => {
    const code = dgp[row * facts.views.length + k];
    return code === 65535 ? [] : [`${view} ${(code * facts.dgp_step).toFixed(2)}`];
  });
  return shown.length ? `DGP ${explorer.operationWords(side)}: ${shown.join(", ")}.` : "";
}

function showGlare(explorer) {
  const limit = +byId("dgp-limit").value, code = Math.round(limit / explorer.facts.dgp_step);
  const chosen = explorer.values.within(explorer.hours);
  byId("dgp-limit").setAttribute("aria-valuetext", `DGP ${limit.toFixed(2)}`);
  byId("dgp-words").textContent = limit.toFixed(2);
  if (explorer.facts.views.length) showViews(explorer, code, chosen, limit);
  if (explorer.positions) showPositions(explorer, code, chosen, limit);
}

function showViews(explorer, code, chosen, limit) {
  const { views } = explorer.facts, cells = views.map(() => []), said = [];
  for (const side of explorer.sides) {
    const dgp = explorer.lux[side].dgp, words = explorer.operationWords(side);
    if (!dgp) {
      cells.forEach(cell => cell.push("not computed"));
      said.push(`${words}: not computed, as windows are in different states.`);
      continue;
    }
    const shares = exceedance(dgp, views.length, chosen, code).map(share => +share.toFixed(1));
    cells.forEach((cell, k) => cell.push(`${shares[k].toFixed(1)} %`));
    said.push(`${words}: ${views.map((view, k) => `${view} ${shares[k].toFixed(1)} %`).join(", ")}.`);
  }
  const names = explorer.sides.map(side => explorer.sides.length > 1 ? `${side.toUpperCase()} ` : "");
  cells.forEach((cell, k) => {
    byId(`exceeded-${k}`).textContent = cell.map((text, at) => names[at] + text).join(", ");
  });
  byId("glare-words").textContent = `DGP above ${limit.toFixed(2)}, ${explorer.hourWords()}, shades ${said.join(" Shades ")}`;
}

function showPositions(explorer, code, chosen, limit) {
  const number = +byId("view-grid").value, plan = explorer.facts.view_plans[number], wanted = +byId("direction").value;
  const directions = plan.azimuths.length, shares = exceedance(explorer.gridDgp, plan.count, chosen, code);
  const values = Float64Array.from(plan.cells, (_, k) => {
    const own = shares.subarray(k * directions, (k + 1) * directions);
    return wanted < 0 ? own.reduce((most, share) => Math.max(most, share), 0) : own[wanted];
  });
  const label = `Hours with DGP above ${limit.toFixed(2)} at the positions of ${plan.name}, ${byId("direction").selectedOptions[0].text}, ${explorer.hourWords()}`;
  explorer.positions.show(plan, `views-${number}-drawing`);
  explorer.positions.draw(values, explorer.scales["%"], label);
  const some = values.filter(share => share > 5).length;
  byId("position-words").textContent = `${some} of ${values.length} positions have DGP above ${limit.toFixed(2)} in more than 5 % of the hours.`;
  explorer.shownPositions = { title: label, unit: "%", values, position: plan.position };
}

async function loadPositions(explorer) {
  if (!explorer.positions) return;
  const number = byId("view-grid").value, plan = explorer.facts.view_plans[number];
  explorer.gridDgp = await explorer.values.codes(`view-grid-${number}`, plan.count);
  const directions = plan.azimuths.map((azimuth, k) => new Option(`${azimuth}°`, k));
  byId("direction").replaceChildren(new Option("worst direction", -1), ...directions);
}
