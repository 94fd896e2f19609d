// Annual maps of classes: the class of the cell at the pointer.

async function startMaps(data) {
  const year = data.year;
  for (const [identifier, map] of Object.entries(data.maps)) {
    const svg = document.getElementById(identifier);
    const cells = new Uint8Array(await unpack(map.cells));
    const say = event => {
      const place = yearCell(year, svg, event);
      if (!place) return showTip(event, "");
      const code = cells[place.day * year.bins + place.bin];
      showTip(event, `${cellWords(year, place)}\n${code in map.texts ? map.texts[code] : "no data"}`);
    };
    svg.addEventListener("pointermove", say);
    svg.addEventListener("pointerdown", say);
    svg.addEventListener("pointerleave", event => showTip(event, ""));
  }
}
