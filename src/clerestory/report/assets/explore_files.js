// What is shown, as a table, as a CSV file and as a PNG image.

// Largest number of sensors in the table; files have all of them
const MOST_ROWS = 500;

function cell(text) {
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function csvLines(explorer, shown) {
  const round = value => Number.isNaN(value) ? "" : String(+value.toPrecision(5));
  const head = shown.position ? "position" : "sensor";
  const name = k => shown.position ? k + 1 : explorer.facts.sensors[explorer.first + k];
  const places = shown.position ?? explorer.facts.position.slice(explorer.first);
  const lines = [[head, "x [m]", "y [m]", "z [m]", `${shown.title} [${shown.unit}]`]];
  shown.values.forEach((value, k) => lines.push([String(name(k)), ...places[k].map(String), round(value)]));
  return lines.map(line => line.map(cell).join(","));
}

function offer(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function startFiles(explorer) {
  for (const button of document.querySelectorAll("button[data-file]")) {
    button.addEventListener("click", async () => {
      const [what, kind] = button.dataset.file.split(".");
      const shown = { moment: explorer.shownMoment, year: explorer.shownYear, positions: explorer.shownPositions }[what];
      if (kind === "csv") return offer(new Blob([csvLines(explorer, shown).join("\n") + "\n"], { type: "text/csv" }), `${what}.csv`);
      const map = { moment: explorer.moment, year: explorer.year, positions: explorer.positions }[what];
      return offer(await map.picture([explorer.facts.title, ...wrapped(shown.title, 70)]), `${what}.png`);
    });
  }
}

function wrapped(text, width) {
  const lines = [""];
  for (const word of text.split(" ")) {
    if (lines.at(-1) && lines.at(-1).length + word.length > width) lines.push("");
    lines.push(`${lines.pop()} ${word}`.trim());
  }
  return lines;
}

// Table of the values of both maps, when it is open
function fillTable(explorer) {
  if (!byId("values").open) return;
  const { shownMoment: moment, shownYear: year, first } = explorer;
  byId("values-moment").textContent = `${explorer.momentWords()} [${moment.unit}]`;
  byId("values-year").textContent = `${year.title} [${year.unit}]`;
  const rows = [...year.values.slice(0, MOST_ROWS)].map((value, k) => {
    const row = document.createElement("tr"), name = document.createElement("th");
    name.scope = "row";
    name.textContent = explorer.facts.sensors[first + k];
    row.append(name);
    for (const shown of [moment.values[k], value]) {
      const data = document.createElement("td");
      data.textContent = Number.isNaN(shown) ? "–" : shown.toLocaleString("en", { maximumFractionDigits: 1 });
      row.append(data);
    }
    return row;
  });
  byId("values-rows").replaceChildren(...rows);
}
