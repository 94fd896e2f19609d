// Hints at wide tables and maps that scroll sideways, reachable by keyboard.

function startScrollHints() {
  const wide = document.querySelectorAll(".wide, .year-scroll, section > .drawing");
  const mark = () => {
    for (const one of wide) {
      const more = one.scrollWidth > one.clientWidth + 1;
      one.classList.toggle("scrolls", more);
      if (more) one.tabIndex = 0; else one.removeAttribute("tabindex");
      const hint = one.previousElementSibling;
      if (hint?.classList.contains("scroll-hint")) hint.hidden = !more;
      else if (more) {
        const made = document.createElement("p");
        made.className = "scroll-hint";
        made.textContent = "scrolls sideways \u2192";
        one.before(made);
      }
    }
  };
  mark();
  addEventListener("resize", mark);
  document.addEventListener("toggle", mark, true);
}
