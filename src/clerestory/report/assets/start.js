// Start of the interactive parts; without scripts the page is a static report.

async function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const root = document.documentElement;
  root.classList.add("scripted");
  startScrollHints();
  let choose = () => {};
  startPlans(data, sensor => choose(sensor));
  choose = await startYear(data, sensor => markChosen(data, sensor));
  await startMaps(data);
  await startRosettes(data);
  startFilm(data.film);
  await startTerms(data.terms);
  await startView(data.view);
  root.dataset.scripts = "done";
}

addEventListener("error", event => { document.documentElement.dataset.error = event.message; });
addEventListener("unhandledrejection", event => { document.documentElement.dataset.error = String(event.reason); });
start();
