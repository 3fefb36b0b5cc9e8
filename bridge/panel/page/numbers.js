// Numbers that can change while the rig runs: sliders and fields; the plant's own words where it refuses.
import { by, make, shown } from "./dom.js";

const TINY = 1e-6; // a lower limit that only says "not zero"
let ask = null;
let rows = new Map();
let known = [];

export function begin(asking) {
  ask = asking;
  by("sought").oninput = () => list();
}

export function forget() {
  known = [];
}

export function show(numbers, watching) {
  const same = numbers.length === known.length && numbers.every((number, i) => number.name === known[i].name);
  known = numbers;
  if (!same) {
    rows = new Map();
    const order = (number) => (number.name.startsWith("controller.gain") ? 0 : number.name === "reference" ? 1 : number.name.startsWith("rig.load") ? 2 : number.name.startsWith("controller") ? 3 : 4);
    const first = numbers.filter((number) => number.group === "first" || number.name === "reference").sort((a, b) => order(a) - order(b));
    by("first").replaceChildren(...first.map((number) => row(number, watching)));
    list();
  }
  for (const number of numbers) for (const update of rows.get(number.name) ?? []) update(number);
}

function list() {
  const sought = by("sought").value.trim().toLowerCase();
  const found = known.filter((number) => number.group !== "first" && number.name !== "reference" && number.name.toLowerCase().includes(sought));
  for (const number of found) rows.delete(number.name);
  by("all").replaceChildren(...found.map((number) => row(number, document.body.classList.contains("watching"))));
}

function row(number, watching) {
  const field = make("input", { type: "text", value: shown(number.value, 5), disabled: watching, inputMode: "decimal", id: `number-${number.name}` });
  const slider = number.slider && make("input", { type: "range", min: number.slider[0], max: number.slider[1], step: "any", value: number.value, disabled: watching, title: number.name });
  const refused = make("p", { className: "refused" });
  const unit = make("span", { className: "unit", textContent: number.unit });
  const made = make("div", { className: "number", title: number.words },
    make("label", { htmlFor: field.id, textContent: number.name }), make("div", { className: "field" }, field, unit));
  slider?.setAttribute("aria-label", number.name);
  if (slider) made.append(slider);
  made.append(make("span", { className: "words", textContent: limits(number) }), refused);

  async function set(text) {
    refused.textContent = "";
    const bare = /^[-+\d.eE\s]+$/.test(text);
    const value = bare ? (number.sent ? `${text.trim()} ${number.sent}` : Number(text)) : text;
    const answer = await ask("set", { changes: { [number.name]: value }, over: by("over").value });
    if (answer.refused) { refused.textContent = answer.refused; field.value = shown(number.value, 5); if (slider) slider.value = number.value; }
  }
  field.onchange = () => set(field.value);
  if (slider) {
    slider.oninput = () => { field.value = shown(Number(slider.value), 4); };
    slider.onchange = () => set(String(Number(Number(slider.value).toPrecision(5))));
  }
  const update = (newer) => {
    Object.assign(number, newer);
    if (document.activeElement !== field) field.value = shown(newer.value, 5);
    if (slider && document.activeElement !== slider) slider.value = newer.value;
  };
  rows.set(number.name, [...(rows.get(number.name) ?? []), update]);
  return made;
}

function limits({ low, high, unit }) {
  const from = low === null ? "" : low > 0 && low < TINY ? "above 0 " : `from ${shown(low)} `;
  return from || high !== null ? `${from}${high === null ? "" : `to ${shown(high)} `}${unit}` : "";
}
