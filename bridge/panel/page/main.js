// The page: what the server tells goes to its part, buttons ask the server.
import * as board from "./board.js";
import { by, make } from "./dom.js";
import * as faults from "./faults.js";
import * as numbers from "./numbers.js";
import * as plots from "./plots.js";
import * as schematic from "./schematic.js";
import { connect } from "./socket.js";

let facts = null;
let guest = "watcher";
let told = null;
let latest = {}; // what has come since the picture was last drawn
let readDue = 0;
const THEMES = ["auto", "light", "dark"];

const watching = () => guest !== "operator" || told?.may === false;

const heard = {
  hello(message) {
    guest = message.guest;
    const options = message.scenarios.map(({ name, title }) => make("option", { value: name, textContent: name, title }));
    by("scenario").replaceChildren(...options);
    by("scenario").value = message.wish;
    by("endless").checked = message.endless;
  },
  run(message) {
    facts = message;
    document.title = `${message.name}: hydrotwin panel`;
    by("title").textContent = message.title;
    by("rig").textContent = `rig ${message.rig}, scenario ${message.name}, ${message.mode}`;
    if ([...by("scenario").options].some((option) => option.value === message.name)) by("scenario").value = message.name;
    board.forget();
    numbers.forget();
    plots.clear();
    schematic.show(message);
    plots.show(message.plots);
    faults.show(message.faults);
  },
  plots(message) { plots.show(message.plots); },
  history(message) {
    plots.add(message.curves);
    board.events(message.events, true);
    faults.heed(message.events);
  },
  numbers(message) { numbers.show(message.numbers, watching()); },
  state(message) {
    told = message;
    document.body.classList.toggle("watching", watching());
    board.state(message);
    const [own, live, busy] = [message.own, message.live, Boolean(message.busy)];
    for (const id of ["scenario", "endless", "start", "stop", "record", "follow"]) by(id).hidden = !own;
    by("endless").parentNode.hidden = !own;
    by("start").disabled = live || busy;
    by("stop").disabled = !live;
    by("reset").disabled = !live;
    for (const [id, on] of [["record", message.roles.includes("recorder")], ["follow", message.roles.includes("follower")]]) {
      by(id).disabled = !live;
      by(id).setAttribute("aria-pressed", String(on));
    }
  },
  frame(message) {
    plots.add(message.curves);
    const drawn = latest.now || latest.lines;
    latest = { now: message.now ?? latest.now, lines: message.lines ?? latest.lines };
    if (!drawn) requestAnimationFrame(draw);
    if (message.events) { board.events(message.events, false); faults.heed(message.events); }
    board.follow(message.estimate, message.health);
  },
};

function draw() {
  const { now, lines } = latest;
  latest = {};
  schematic.move(now, lines);
  if (performance.now() < readDue) return;
  readDue = performance.now() + 200;
  schematic.read(now, facts?.turns);
}

const ask = connect((message) => heard[message.type]?.(message), (open) => {
  if (!open) { by("phase").textContent = "no connection"; by("phase").className = "badge bad"; }
});

async function order(what, more) {
  const answer = await ask(what, more);
  by("refusal").textContent = answer.refused ?? "";
}

plots.begin(ask);
numbers.begin(ask);
faults.begin(ask);
by("start").onclick = () => order("start", { scenario: by("scenario").value, endless: by("endless").checked });
by("stop").onclick = () => order("stop");
by("reset").onclick = () => order("reset");
for (const id of ["record", "follow"]) by(id).onclick = () => order(id, { on: by(id).getAttribute("aria-pressed") !== "true" });

function theme() {
  const wanted = localStorage.getItem("theme") ?? "auto";
  const dark = wanted === "dark" || (wanted === "auto" && matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  plots.redraw();
}
by("theme").onclick = () => {
  localStorage.setItem("theme", THEMES[(THEMES.indexOf(localStorage.getItem("theme") ?? "auto") + 1) % THEMES.length]);
  theme();
};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", theme);
theme();
