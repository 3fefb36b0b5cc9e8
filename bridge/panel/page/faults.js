// Faults: what can be injected, its numbers, and those that are there now with a way to end each.
import { by, make } from "./dom.js";

let ask = null;
let targets = [];
const active = new Map();

export function begin(asking) {
  ask = asking;
  by("fault").onsubmit = (event) => { event.preventDefault(); inject(); };
}

export function show(known) {
  targets = known;
  active.clear();
  list();
  const target = make("select", { id: "fault-target", onchange: kinds }, ...targets.map(({ target: name }) => make("option", { textContent: name })));
  target.setAttribute("aria-label", "What fails");
  const kind = make("select", { id: "fault-kind", onchange: sizes });
  kind.setAttribute("aria-label", "How it fails");
  by("fault").replaceChildren(target, kind, make("span", { className: "words", id: "fault-words" }), make("div", { id: "fault-sizes", style: "display:contents" }),
    make("button", { id: "inject", textContent: "Inject" }), make("p", { className: "refused", id: "fault-refused" }));
  target.value = targets.some((one) => one.target === "sensor.p2") ? "sensor.p2" : target.value;
  kinds();
}

const chosen = () => targets.find((one) => one.target === by("fault-target").value);

function kinds() {
  by("fault-kind").replaceChildren(...(chosen()?.kinds ?? []).map(({ name }) => make("option", { textContent: name })));
  sizes();
}

function sizes() {
  const kind = chosen()?.kinds.find((one) => one.name === by("fault-kind").value);
  by("fault-words").textContent = kind?.words ?? "";
  const fields = (kind?.sizes ?? []).map((size) => field(size.name, `${size.name}${size.unit ? ` [${size.unit}]` : ""}${size.needed ? " *" : ""}`, size.unit, size.words));
  by("fault-sizes").replaceChildren(...fields, field("lasts", `lasts [s]${kind?.lasting ? " *" : ""}`, "s", "how long; empty: to the end"));
}

function field(name, label, unit, words) {
  return make("label", { title: words }, label, make("input", { name, "data-unit": unit, placeholder: words.slice(0, 24) }));
}

async function inject() {
  const fault = { target: by("fault-target").value, kind: by("fault-kind").value };
  for (const input of by("fault-sizes").querySelectorAll("input")) {
    const text = input.value.trim();
    if (text) fault[input.name] = /^[-+\d.eE]+$/.test(text) ? (input.dataset.unit ? `${text} ${input.dataset.unit}` : Number(text)) : text;
  }
  if (chosen()?.target.startsWith("link.") && fault.kind === "delay") fault.law ??= "constant";
  const answer = await ask("fault", { fault });
  by("fault-refused").textContent = answer.refused ?? "";
}

export function heed(events) {
  for (const { fault } of events) {
    if (!fault) continue;
    if (fault.begins) active.set(fault.name, fault.words);
    else active.delete(fault.name);
  }
  list();
}

function list() {
  by("active").replaceChildren(...[...active].map(([name, words]) => make("li", {}, make("span", { textContent: words }),
    make("button", { textContent: "End", onclick: async () => { by("fault-refused").textContent = (await ask("fault", { fault: { end: name } })).refused ?? ""; } }))));
}
