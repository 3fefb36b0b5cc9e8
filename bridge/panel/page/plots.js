// Live curves: a buffer per message topic, a picture per unit; pause, zoom, and detail from the server's memory.
/* global uPlot */
import { by, make, shown } from "./dom.js";

const KEEP = 120; // [s] in the page
const HEIGHT = 170; // [px]
const dark = () => document.documentElement.dataset.theme === "dark";
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let ask = null;
let buffers = {}; // topic -> { t: [], v: { key: [] } }
let frozen = null; // the same, of a pause, as finely as the server has it
let view = null; // [begin, end] of a pause
let latest = 0;
let plots = [];
let sheets = new Map();
let due = false;

export function begin(asking) {
  ask = asking;
  by("pause").onclick = () => (view ? goOn() : pause([latest - span(), latest]));
  by("span").onchange = () => (view ? pause([view[1] - span(), view[1]]) : refresh());
  const scaled = (factor) => { const [a, b] = view ?? [latest - span(), latest]; const h = ((b - a) * factor) / 2; pause([(a + b) / 2 - h, (a + b) / 2 + h]); };
  by("closer").onclick = () => scaled(0.5);
  by("farther").onclick = () => scaled(2);
  const moved = (share) => { const [a, b] = view ?? [latest - span(), latest]; pause([a + share * (b - a), b + share * (b - a)]); };
  by("earlier").onclick = () => moved(-0.5);
  by("later").onclick = () => moved(0.5);
  addEventListener("scroll", refresh, { passive: true });
  addEventListener("resize", () => { for (const sheet of sheets.values()) sheet.chart?.setSize({ width: sheet.box.clientWidth, height: HEIGHT }); });
}

export function clear() {
  buffers = {};
  latest = 0;
  if (view) goOn();
}

export function show(described) {
  plots = described;
  for (const sheet of sheets.values()) sheet.chart?.destroy();
  sheets = new Map();
  by("sheets").replaceChildren();
  for (const plot of plots) if (plot.open) openSheet(plot);
  offer();
}

export function redraw() {
  const open = [...sheets.values()].map((sheet) => sheet.plot.name);
  show(plots.map((plot) => ({ ...plot, open: open.includes(plot.name) })));
}

function openSheet(plot) {
  plot.open = true;
  const close = make("button", { textContent: "×", title: "Close", onclick: () => { plot.open = false; sheets.get(plot.name).chart?.destroy(); box.remove(); sheets.delete(plot.name); offer(); } });
  const box = make("div", { className: "card sheet", id: `sheet-${plot.name}` }, make("h3", { textContent: `${plot.title} ` }));
  if (!["position_mm"].includes(plot.name)) box.firstChild.append(close);
  by("sheets").append(box);
  sheets.set(plot.name, { plot, box, chart: null, curves: [] });
  refresh();
}

function offer() {
  const closed = plots.filter((plot) => !sheets.has(plot.name));
  by("more").replaceChildren(...closed.map((plot) => make("button", { textContent: `+ ${plot.title}`, onclick: () => { openSheet(plot); offer(); } })));
}

// New points of every topic, from a frame or from the history.
export function add(curves) {
  for (const [topic, { t, v }] of Object.entries(curves)) {
    const own = (buffers[topic] ??= { t: [], v: {} });
    for (const time of t) own.t.push(time);
    for (const [key, values] of Object.entries(v)) {
      const kept = (own.v[key] ??= new Array(own.t.length - t.length).fill(null));
      for (const value of values) kept.push(value);
    }
    for (const kept of Object.values(own.v)) while (kept.length < own.t.length) kept.push(null); // not told this time
    latest = Math.max(latest, t[t.length - 1] ?? 0);
    trim(own);
  }
  if (!view) refresh();
}

function trim(own) {
  if (own.t.length < 2000 || own.t[Math.floor(own.t.length / 4)] > latest - KEEP) return;
  const first = own.t.findIndex((time) => time > latest - KEEP);
  own.t.splice(0, first);
  for (const values of Object.values(own.v)) values.splice(0, first);
}

const span = () => Number(by("span").value);

async function pause(range) {
  view = [Math.max(0, range[0]), Math.max(range[1], range[0] + 0.005)];
  by("pause").setAttribute("aria-pressed", "true");
  by("pause").textContent = "Go on";
  refresh();
  if (view[1] - view[0] > KEEP) return;
  const asked = view;
  const found = await ask("detail", { begin: view[0], end: view[1] });
  if (asked === view && found.done && Object.keys(found.done.curves).length) { frozen = found.done.curves; refresh(); }
}

function goOn() {
  view = frozen = null;
  by("pause").setAttribute("aria-pressed", "false");
  by("pause").textContent = "Pause";
  refresh();
}

function refresh() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => { due = false; for (const sheet of sheets.values()) draw(sheet); });
}

function draw(sheet) {
  const place = sheet.box.getBoundingClientRect();
  if (place.bottom < -200 || place.top > innerHeight + 200) return;
  const [from, to] = view ?? [latest - span(), latest];
  const source = { ...buffers, ...(frozen ?? {}) };
  const curves = sheet.plot.curves.filter((curve) => source[curve.topic]?.v[curve.key]);
  if (!curves.length) return;
  const topics = [...new Set(curves.map((curve) => curve.topic))];
  if (!sheet.chart || curves.length !== sheet.curves.length) build(sheet, topics.flatMap((topic) => curves.filter((curve) => curve.topic === topic)));
  const tables = topics.map((topic) => cut(source[topic], sheet.curves.filter((curve) => curve.topic === topic), from, to));
  const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
  sheet.chart.setData(data, false);
  sheet.chart.setScale("x", { min: from, max: to });
  sheet.box.dataset.points = data[0].length;
}

function cut({ t, v }, curves, from, to) {
  let a = t.findIndex((time) => time >= from);
  if (a < 0) a = t.length;
  let b = t.length;
  while (b > a && t[b - 1] > to) b--;
  return [t.slice(Math.max(0, a - 1), b + 1), ...curves.map((curve) => v[curve.key].slice(Math.max(0, a - 1), b + 1))];
}

function build(sheet, curves) {
  sheet.chart?.destroy();
  sheet.curves = curves;
  const series = curves.map((curve) => ({
    label: curve.label, stroke: dark() ? curve.dark : curve.light, width: 1.3, spanGaps: true, points: { show: false },
    dash: curve.dashed ? [5, 4] : undefined, paths: curve.held ? uPlot.paths.stepped({ align: 1 }) : undefined,
    value: (_, value) => shown(value),
  }));
  const axis = { stroke: style("--soft"), grid: { stroke: style("--grid"), width: 1 }, ticks: { stroke: style("--grid") }, font: "11px sans-serif" };
  sheet.chart = new uPlot({
    width: sheet.box.clientWidth - 22, height: HEIGHT, scales: { x: { time: false }, y: { auto: true } },
    cursor: { sync: { key: "time", setSeries: false }, drag: { x: true, y: false, setScale: false } },
    hooks: { setSelect: [(chart) => { const { left, width } = chart.select; if (width > 4) { pause([chart.posToVal(left, "x"), chart.posToVal(left + width, "x")]); chart.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false); } }] },
    axes: [{ ...axis, values: (_, ticks) => ticks.map((tick) => `${shown(tick, 6)} s`) }, { ...axis, size: 52 }],
    series: [{ label: "t", value: (_, time) => (time === null ? "–" : `${time.toFixed(3)} s`) }, ...series],
  }, [[], ...series.map(() => [])], sheet.box);
  sheet.chart.over.ondblclick = () => goOn();
}
