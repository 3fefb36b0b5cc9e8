// The drive's own picture, alive: pressure as colour along the pipes, the piston, the spool, a shaft.
import { by, make } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";
const PIECES = 10; // of a pipe, between the places at which its pressure is told
const BENDS = 8; // points of a piece
const NARROW = matchMedia("(max-width: 40rem)"); // a phone: no room for words beside the parts
let motion = null;
let pieces = [];
let parts = {};
let chambers = [];
let hand = null;

const all = (part) => [...by("drive").querySelectorAll(`[id^="${motion.name}-${part}."]`)];

export function show(facts) {
  by("drive").innerHTML = facts.svg;
  motion = facts.motion;
  pieces = [];
  chambers = [];
  hand = null;
  if (!motion) return;
  fit();
  parts = Object.fromEntries(["moving", "travelled", "spool", "turning"].map((name) => [name, all(name)]));
  for (let number = 1; number <= motion.ends.length; number++) pieces.push(divided(all(`pipe${number}`)[0]));
  divideChambers();
  if (motion.turns && parts.turning.length) addHand(parts.turning[0].getBBox());
}

function fit() {
  const svg = by("drive").querySelector("svg");
  svg.dataset.whole ??= svg.getAttribute("viewBox");
  const [left, top, width, height] = svg.dataset.whole.split(" ").map(Number);
  svg.setAttribute("viewBox", NARROW.matches ? `${left + 20} ${top} ${width * 0.86} ${height}` : svg.dataset.whole);
}
NARROW.addEventListener("change", () => motion && fit());

function divided(group) {
  const path = group.querySelector("path");
  const length = path.getTotalLength();
  const made = [];
  path.style.stroke = "none";
  for (let k = 0; k < PIECES; k++) {
    const points = [];
    for (let j = 0; j <= BENDS; j++) {
      const at = path.getPointAtLength((length * (k + j / BENDS)) / PIECES);
      points.push(`${at.x.toFixed(2)},${at.y.toFixed(2)}`);
    }
    const piece = document.createElementNS(SVG, "polyline");
    piece.setAttribute("points", points.join(" "));
    piece.setAttribute("style", `fill:none;stroke-width:6;stroke-linejoin:miter;stroke-linecap:${k ? "butt" : "round"}`);
    group.append(piece);
    made.push(piece);
  }
  return made;
}

function divideChambers() {
  const body = all("chambers")[0]?.querySelector("path");
  if (!body) return;
  const room = body.getBBox();
  body.style.fill = "none";
  for (const name of ["p_upper", "p_lower"]) {
    const rect = document.createElementNS(SVG, "rect");
    rect.setAttribute("x", room.x);
    rect.setAttribute("width", room.width);
    rect.style.fillOpacity = 0.45;
    body.parentNode.insertBefore(rect, body);
    chambers.push({ rect, name, room });
  }
}

function addHand(circle) {
  hand = document.createElementNS(SVG, "line");
  const [x, y] = [circle.x + circle.width / 2, circle.y + circle.height / 2];
  for (const [name, value] of Object.entries({ x1: x, y1: y, x2: x + circle.width * 0.42, y2: y })) hand.setAttribute(name, value);
  hand.setAttribute("style", "stroke:#b3261e;stroke-width:3;stroke-linecap:round");
  hand.middle = `${x} ${y}`;
  parts.turning[0].parentNode.append(hand);
}

export function move(now, lines) {
  if (!motion) return;
  if (lines) lines.forEach((along, pipe) => colourPipe(pieces[pipe], along));
  else if (now) motion.ends.forEach(([first, last], pipe) => straight(pieces[pipe], now[first], last ? now[last] : 0));
  if (!now) return;
  if (now.spool !== null && now.spool !== undefined) shift(parts.spool, -now.spool * motion.box, 0);
  if (now.position === null || now.position === undefined) return;
  if (motion.turns) hand?.setAttribute("transform", `rotate(${(-now.position * 180) / Math.PI} ${hand.middle})`);
  else movePiston(Math.min(1, Math.max(0, now.position / motion.stroke)), now);
}

function movePiston(share, now) {
  const up = (share - motion.drawn_at) * motion.travel;
  shift(parts.moving, 0, -up);
  for (const part of parts.travelled) {
    const box = part.foot ?? (part.foot = part.getBBox().y + part.getBBox().height);
    const scale = Math.max(0, (motion.foot + up) / motion.foot);
    part.setAttribute("transform", `translate(0 ${box * (1 - scale)}) scale(1 ${scale})`);
  }
  for (const { rect, name, room } of chambers) {
    const below = motion.foot + up;
    const high = name === "p_lower" ? below : Math.max(0, room.height - below);
    rect.setAttribute("y", name === "p_lower" ? room.y + room.height - below : room.y);
    rect.setAttribute("height", Math.max(0, high));
    if (now[name] !== null && now[name] !== undefined) rect.style.fill = colour(now[name]);
  }
}

const shift = (groups, x, y) => groups.forEach((group) => group.setAttribute("transform", `translate(${x} ${y})`));

function colourPipe(own, along) {
  own.forEach((piece, k) => { piece.style.stroke = colour((along[k] + along[k + 1]) / 2); });
}

function straight(own, first, last) {
  if (first === null || first === undefined || last === null || last === undefined) return;
  own.forEach((piece, k) => { piece.style.stroke = colour(first + ((last - first) * (k + 0.5)) / PIECES); });
}

function colour(pressure) {
  const stops = motion.stops;
  const above = stops.findIndex((stop) => stop[0] >= pressure);
  if (above === 0) return `rgb(${stops[0].slice(1)})`;
  if (above < 0) return `rgb(${stops[stops.length - 1].slice(1)})`;
  const [low, high] = [stops[above - 1], stops[above]];
  const share = (pressure - low[0]) / (high[0] - low[0]);
  return `rgb(${[1, 2, 3].map((i) => Math.round(low[i] + share * (high[i] - low[i])))})`;
}

const READINGS = [
  ["position", "x", 1e3, "mm"], ["velocity", "v", 1e3, "mm/s"], ["p1", "p1", 1e-5, "bar"], ["p_lower", "p2", 1e-5, "bar"],
  ["p_upper", "p3", 1e-5, "bar"], ["spool", "spool", 100, "%"], ["reference", "command", 100, "%"],
];

export function read(now, turns) {
  if (!now) return;
  const rows = READINGS.map(([field, label, scale, unit]) => {
    const factor = turns && unit.startsWith("mm") ? 1 : scale;
    const words = turns ? unit.replace("mm", "rad") : unit;
    const value = now[field] === undefined || now[field] === null ? "–" : `${(now[field] * factor).toFixed(1)} ${words}`;
    return make("div", {}, make("dt", { textContent: label }), make("dd", { textContent: value }));
  });
  by("readings").replaceChildren(...rows);
}
