// What is told in words: state of safety, timing, bands, events, and what a follower makes of the rig.
import { by, make, shown } from "./dom.js";

const LONGEST = 200; // events in the page
const SILENT = 3000; // [ms] after which a follower counts as gone
const GOOD = { running: "good", degraded: "warn", safe: "bad", latched: "bad", failed: "bad" };
const HINTS = { latched: "Latched: commands do not act until somebody presses Reset.", safe: "Safe: commands do not act; the next valid one, or Reset, ends it." };
const ms = (seconds) => (seconds === undefined ? "–" : `${(1e3 * seconds).toFixed(2)} ms`);

function table(target, rows) {
  target.replaceChildren(...rows.map(([name, value, kind = ""]) => make("tr", { className: kind }, make("td", { textContent: name }), make("td", { textContent: value }))));
}

export function state(told) {
  const plant = told.status.plant;
  const phase = told.busy || (told.live ? (plant?.phase ?? "waiting") : (plant?.phase ?? "no run"));
  by("phase").textContent = told.live || told.busy || ["failed"].includes(phase) ? phase : "stopped";
  by("phase").className = `badge ${told.live ? (GOOD[phase] ?? "") : ""}`;
  by("clock").textContent = told.time ? `${told.time.toFixed(1)} s` : "";
  by("note").textContent = told.note || (told.live ? (HINTS[phase] ?? "") : "");
  timing(told, plant);
  bands(told.bands);
  by("follower-gone").hidden = performance.now() - estimated < SILENT;
}

function timing(told, plant) {
  const refused = Object.entries(plant ?? {}).filter(([name]) => name.startsWith("refused/"));
  const { late_p50, late_p99, late_max, trip_p50 } = told.timing;
  const rows = [
    ["state", plant?.phase ?? "–", GOOD[plant?.phase] === "bad" ? "bad" : ""],
    ["safe states", shown(plant?.safe_states ?? null), plant?.safe_states ? "bad" : ""],
    ["commands taken / late", `${shown(plant?.commands ?? null, 9)} / ${shown(plant?.late ?? null, 9)}`, plant?.late ? "bad" : ""],
    ...refused.map(([name, count]) => [`refused: ${name.slice(8)}`, shown(count, 9), "bad"]),
    ["overruns, worst", plant?.overruns === undefined ? "–" : `${plant.overruns}, ${ms(plant.worst_overrun)}`],
    ["lateness of ticks, 10 s: median / 99 % / most", late_p50 === undefined ? "–" : [late_p50, late_p99, late_max].map(ms).join(" / ")],
    ["measurement to command, median", ms(trip_p50)],
    ["beside the plant", told.roles.join(", ") || "–"],
    ["recording", told.recording ?? "–"],
  ];
  table(by("timing"), rows);
}

function bands(judged) {
  const broken = judged?.bands.filter((band) => band.passed === false).length ?? 0;
  const open = judged?.bands.filter((band) => band.passed === null).length ?? 0;
  by("verdict").textContent = !judged?.bands.length || judged.words ? "" : broken ? `${broken} band${broken > 1 ? "s" : ""} broken` : open ? "bands open" : "bands kept";
  by("verdict").className = `badge ${broken ? "bad" : open ? "" : "good"}`;
  const rows = (judged?.bands ?? []).map((band) => [band.band, band.found, band.passed === null ? "open" : band.passed ? "good" : "bad"]);
  const words = judged?.words || (judged ? `judged by what has come until ${shown(judged.until, 3)} s${judged.final ? ", final" : ""}` : "");
  const list = make("table");
  table(list, judged?.words ? [] : rows);
  by("bands").replaceChildren(list, make("p", { className: "words", textContent: words }));
}

export function events(list, anew) {
  if (anew) by("events").replaceChildren();
  by("events").prepend(...[...list].reverse().map(({ t, kind, text, grave }) => make("li", { className: grave ? "grave" : "" },
    make("time", { textContent: `${t.toFixed(3)} s` }), `${kind}: ${text}`)));
  while (by("events").children.length > LONGEST) by("events").lastChild.remove();
}

let follower = {};
let estimated = 0; // when it was heard last [ms]

export function follow(estimate, health) {
  if (estimate === undefined && health === undefined) return;
  estimated = performance.now();
  follower = { estimate: estimate ?? follower.estimate, health: health ?? follower.health };
  by("health-card").hidden = false;
  const parts = [];
  if (follower.health) {
    const { verdict, bad, confidence, since, findings, limit } = follower.health;
    const words = [verdict, confidence === null ? "" : `confidence ${shown(100 * confidence, 3)} %`, since === null ? "" : `since ${shown(since, 4)} s`].filter(Boolean).join(", ");
    const list = make("table");
    table(list, findings.map(({ name, deviate }) => [name, shown(deviate, 3), Math.abs(deviate) > limit ? "bad" : ""]));
    parts.push(make("p", { className: `badge ${bad ? "bad" : verdict === "healthy" ? "good" : ""}`, id: "health-verdict", textContent: words }), list);
  }
  if (follower.estimate) {
    const list = make("table");
    table(list, follower.estimate.rows.map(([name, value, deviation, unit]) => [name, `${shown(value)} ± ${shown(deviation, 2)} ${unit}`]));
    parts.push(make("p", { className: "words", textContent: `estimate: ${follower.estimate.standing}` }), list);
  }
  by("health").replaceChildren(...parts);
}

export function forget() {
  follower = {};
  by("health-card").hidden = true;
  events([], true);
}
