"""The page of a chart: its data inline, a canvas, and a readout under the pointer. It refers to nothing else."""

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>@TITLE@</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.5 "DejaVu Sans", Verdana, Arial, sans-serif; color: #1c2430; max-width: 62rem; margin: 1.5rem auto;
  padding: 0 1rem }
h1 { font-size: 1.25rem } canvas { width: 100%; display: block; cursor: crosshair }
#readout { min-height: 3.2em; font-variant-numeric: tabular-nums } .soft { color: #5c6675; font-size: .85rem }
.key { display: inline-block; width: .8rem; height: .8rem; margin: 0 .35rem 0 .9rem }
</style></head>
<body><h1>@TITLE@</h1><div id="keys" class="soft"></div><canvas id="chart" width="1400" height="840"></canvas>
<p id="readout">Move over the chart to read it.</p>
<p class="soft">Colours: linear theory, multipliers counted. @FIXED@ @RUNS@</p>
<script>
const d = @DATA@;
const c = document.getElementById("chart"), g = c.getContext("2d"), out = document.getElementById("readout");
const L = 110, R = 20, T = 15, B = 75, W = c.width - L - R, H = c.height - T - B;
const x0 = d.x[0], x1 = d.x[d.x.length - 1], y0 = d.y[0], y1 = d.y[d.y.length - 1];
const px = x => L + (x - x0) / (x1 - x0) * W, py = y => T + H - (y - y0) / (y1 - y0) * H;
const near = (a, v) => a.reduce((best, w, i) => Math.abs(w - v) < Math.abs(a[best] - v) ? i : best, 0);
const bound = (a, i) => i <= 0 ? a[0] : i >= a.length ? a[a.length - 1] : (a[i - 1] + a[i]) / 2;
function ticks(lo, hi) {
  const raw = (hi - lo) / 7, p = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(m => m * p).find(s => s >= raw), found = [];
  for (let k = Math.ceil(lo / step); k * step <= hi * (1 + 1e-9); k++) found.push(+(k * step).toPrecision(10));
  return found;
}
function draw(at) {
  g.clearRect(0, 0, c.width, c.height);
  for (let j = 0; j < d.y.length; j++) for (let i = 0; i < d.x.length; i++) {
    const a = px(bound(d.x, i)), b = px(bound(d.x, i + 1)), s = py(bound(d.y, j)), e = py(bound(d.y, j + 1));
    g.fillStyle = d.colours[Math.min(d.outside[j][i], d.colours.length - 1)];
    g.fillRect(a, e, b - a + 0.6, s - e + 0.6);
  }
  g.lineWidth = 3;
  d.runs.forEach(([x, y, bad], i) => {
    g.strokeStyle = g.fillStyle = bad ? "#a3231f" : "#1f6b39"; g.beginPath();
    if (bad) { g.moveTo(px(x) - 7, py(y) - 7); g.lineTo(px(x) + 7, py(y) + 7);
      g.moveTo(px(x) - 7, py(y) + 7); g.lineTo(px(x) + 7, py(y) - 7); g.stroke(); }
    else { g.arc(px(x), py(y), 5, 0, 7); g.fill(); }
    if (d.parted[i]) { g.strokeStyle = "#1c2430"; g.beginPath(); g.arc(px(x), py(y), 13, 0, 7); g.stroke(); }
  });
  g.strokeStyle = "#1c2430"; g.lineWidth = 1.5; g.strokeRect(L, T, W, H);
  g.fillStyle = "#1c2430"; g.font = "22px DejaVu Sans, Verdana, sans-serif"; g.textAlign = "center";
  for (const t of ticks(x0, x1)) g.fillText(t, px(t), T + H + 28);
  g.fillText(d.labels[0], L + W / 2, T + H + 62); g.textAlign = "right";
  for (const t of ticks(y0, y1)) g.fillText(t, L - 10, py(t) + 7);
  g.save(); g.translate(26, T + H / 2); g.rotate(-Math.PI / 2); g.textAlign = "center";
  g.fillText(d.labels[1], 0, 0); g.restore();
  if (at) { g.strokeStyle = "#1c2430"; g.setLineDash([4, 4]); g.beginPath(); g.moveTo(at[0], T); g.lineTo(at[0], T + H);
    g.moveTo(L, at[1]); g.lineTo(L + W, at[1]); g.stroke(); g.setLineDash([]); }
}
c.addEventListener("mousemove", event => {
  const box = c.getBoundingClientRect(), k = c.width / box.width;
  const X = (event.clientX - box.left) * k, Y = (event.clientY - box.top) * k;
  if (X < L || X > L + W || Y < T || Y > T + H) return;
  const i = near(d.x, x0 + (X - L) / W * (x1 - x0)), j = near(d.y, y0 + (T + H - Y) / H * (y1 - y0));
  const n = d.outside[j][i], angle = d.peak ? 0 : d.angle[j][i];
  const how = angle > Math.PI - 1e-4 ? "a flip, at half the sampling frequency" : angle < 1e-4 ? "no swing" :
    `a swing at ${(angle / Math.PI).toPrecision(4)} of half the sampling frequency`;
  const all = d.peak ? 0 : d.total[j][i];
  const at = [d.x[i], d.y[j]].map((v, k) => `${d.labels[k]} ${v.toPrecision(4)}`).join(", ");
  const often = d.peak && d.often[j][i] ? `at ${d.often[j][i].toPrecision(3)} Hz` : "irregularly";
  let words = d.peak ? `${at}: swings by ${d.peak[j][i].toPrecision(3)} mm, peak to peak, ${often}.` :
    `${at}: ${all - n} of ${all} multipliers stable; the largest is ${d.size[j][i].toPrecision(6)}, ${how}.`;
  for (const r of d.runs) if (Math.hypot(px(r[0]) - X, py(r[1]) - Y) < 12)
    words += ` Run: ${r[3]}.`;
  out.textContent = words; draw([px(d.x[i]), py(d.y[j])]);
});
document.getElementById("keys").innerHTML = d.words.map((w, i) =>
  `<span class="key" style="background:${d.colours[i]}"></span>${w}`).join("");
draw();
</script></body></html>
"""
