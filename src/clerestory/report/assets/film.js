// Animation of a day: synchronous frames of all views, played or selected.

function startFilm(film) {
  if (!film) return;
  const button = document.getElementById("film-play"), slider = document.getElementById("film-slider");
  const look = document.getElementById("film-look"), clock = document.getElementById("film-clock");
  const scales = document.getElementById("film-scales"), sheet = document.getElementById("film-sheet");
  const screens = [...document.querySelectorAll("#film .screens figure")];
  const last = film.clock.length - 1, pause = Math.min(500, Math.max(120, 12000 / film.clock.length));
  let timer = 0;

  const show = frame => {
    slider.value = frame;
    slider.setAttribute("aria-valuetext", film.clock[frame]);
    clock.textContent = film.clock[frame];
    film.views.forEach((view, k) => {
      const address = view[look.value][frame];
      if (address) screens[k].querySelector("img").src = address;
      screens[k].classList.toggle("missing", !address);
      screens[k].querySelector(".said").textContent = view.notes[frame];
    });
    scales.hidden = look.value !== "luminance";
    for (const image of sheet.children) image.classList.toggle("shown", +image.dataset.frame === frame);
  };
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    button.textContent = "Play";
  };
  const play = () => {
    button.textContent = "Pause";
    timer = setInterval(() => show(+slider.value < last ? +slider.value + 1 : 0), pause);
  };

  // Contact sheet: an overview in print; its frames are buttons on the screen
  const pictures = view => view.seen.filter(Boolean).length;
  const view = film.views.reduce((most, other) => pictures(other) > pictures(most) ? other : most);
  const frames = [...view.seen.keys()].filter(frame => view.seen[frame]), count = Math.min(8, frames.length);
  for (let k = 0; k < count; k++) {
    const frame = frames[Math.round(k * (frames.length - 1) / Math.max(1, count - 1))];
    const item = document.createElement("button"), image = new Image(), words = document.createElement("span");
    image.src = view.seen[frame];
    image.alt = "";
    words.textContent = film.clock[frame];
    item.type = "button";
    item.dataset.frame = frame;
    item.append(image, words);
    item.addEventListener("click", () => { stop(); show(frame); });
    sheet.append(item);
  }

  button.addEventListener("click", () => timer ? stop() : play());
  slider.addEventListener("input", () => { stop(); show(+slider.value); });
  look.addEventListener("change", () => show(+slider.value));
  show(+slider.value);
}
