// Theme of all pages of the viewer: the system's, or the one chosen at the top. A page that draws by itself hears of changes by the event
// "seaglint-theme" of the window.
const NAME = "seaglint-theme";

function apply(theme) {
  if (theme) document.documentElement.dataset.theme = theme; else delete document.documentElement.dataset.theme;
  window.Quasar?.Dark.set(theme ? theme === "dark" : "auto");
  window.dispatchEvent(new Event(NAME));
}

function chosen() {
  try { return localStorage.getItem(NAME) || ""; } catch { return ""; /* storage may be forbidden */ }
}

apply(chosen());  // before anything is drawn
window.addEventListener("load", () => {
  document.querySelector("[data-theme-choice]").value = chosen();
  apply(chosen());  // Quasar is there now
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => apply(chosen()));
document.addEventListener("change", (event) => {
  if (!event.target.matches("[data-theme-choice]")) return;
  try { localStorage.setItem(NAME, event.target.value); } catch { /* storage may be forbidden */ }
  apply(event.target.value);
});
