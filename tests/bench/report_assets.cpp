#include "tests/bench/report_assets.h"

namespace macula::bench {

const std::string_view kPageStyle = R"css(
:root { --ink:#1d2430; --dim:#5d6b7e; --paper:#fff; --card:#f5f7fa; --line:#d9dfe7; --accent:#0b6bcb; --front:#d1495b; --base:#7b8794; }
@media (prefers-color-scheme: dark) { :root { --ink:#e6eaf0; --dim:#9aa7b8; --paper:#12161c; --card:#1a2029; --line:#2c3542; --accent:#5aa9f8; --front:#ff7b8b; --base:#8a96a5; } }
* { box-sizing:border-box }
body { margin:0; font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif; color:var(--ink); background:var(--paper) }
header, main { max-width:1180px; margin:0 auto; padding:0 24px }
header { padding-top:36px }
h1 { font-size:30px; margin:0 0 4px; letter-spacing:-.4px } h2 { font-size:23px; margin:52px 0 8px; padding-top:12px; border-top:1px solid var(--line) }
h3 { font-size:17px; margin:28px 0 6px }
p.lead { color:var(--dim); max-width:76ch; margin:4px 0 14px }
nav { position:sticky; top:0; background:var(--paper); border-bottom:1px solid var(--line); z-index:2; padding:8px 24px; overflow-x:auto; white-space:nowrap }
nav a { color:var(--accent); text-decoration:none; margin-right:18px } nav a:hover { text-decoration:underline }
pre { background:var(--card); border:1px solid var(--line); border-radius:6px; padding:10px 12px; overflow-x:auto; font-size:13px }
.facts { display:flex; flex-wrap:wrap; gap:4px 22px; color:var(--dim); font-size:13.5px } .facts b { color:var(--ink); font-weight:600 }
.scroll { overflow:auto; max-height:460px; border:1px solid var(--line); border-radius:6px; margin:8px 0 }
table { border-collapse:collapse; font-size:13px; font-variant-numeric:tabular-nums; width:100% }
th { position:sticky; top:0; background:var(--card); text-align:right; cursor:pointer; font-weight:600; border-bottom:1px solid var(--line) }
th, td { padding:4px 10px; white-space:nowrap } td { text-align:right; border-bottom:1px solid var(--line) } td.t, th.t { text-align:left }
tr.front td { font-weight:600 } tr:hover td { background:var(--card) }
details { margin:10px 0 } summary { cursor:pointer; color:var(--accent) }
.grid { display:grid; grid-template-columns:repeat(auto-fill,minmax(340px,1fr)); gap:18px }
figure { margin:0; border:1px solid var(--line); border-radius:8px; padding:10px 10px 6px } figcaption { font-size:13.5px; font-weight:600; padding:0 4px 4px }
svg { width:100%; height:auto; display:block } svg text { fill:var(--dim); font-size:11px } svg .axis { stroke:var(--line) } svg .baseline { fill:none; stroke:var(--base); stroke-width:2; stroke-dasharray:5 4 } svg .run { fill:none; stroke-width:1.5 } svg .best { fill:none; stroke:var(--front); stroke-width:2 }
svg circle { fill:var(--accent); fill-opacity:.75 } svg circle.u { fill:var(--base) } svg circle.f { fill:var(--front); fill-opacity:1 }
.key span { margin-right:16px; font-size:13px; color:var(--dim) } .key i { display:inline-block; width:18px; height:0; border-top:3px solid; vertical-align:middle; margin-right:6px }
.controls { margin:8px 0 12px; font-size:13.5px; color:var(--dim) } select { font:inherit; color:inherit; background:var(--card); border:1px solid var(--line); border-radius:5px; padding:2px 6px; margin:0 12px 0 4px; max-width:min(46ch, 100%) } figure select { margin:0 0 4px; width:100% }
.wipe { position:relative; line-height:0; overflow:hidden; border-radius:6px; background:#000; aspect-ratio:1 } .wipe img { width:100%; height:100%; position:absolute; inset:0; image-rendering:pixelated; user-select:none }
.wipe .over { clip-path:inset(0 0 0 50%) } .wipe .bar { position:absolute; top:0; bottom:0; width:2px; background:#fff; left:50%; box-shadow:0 0 4px #000 }
.wipe input { position:absolute; inset:0; width:100%; height:100%; opacity:0; cursor:ew-resize; margin:0 }
.wipe small { position:absolute; bottom:6px; font:12px system-ui; color:#fff; background:#0009; padding:3px 6px; border-radius:4px; line-height:1.2; pointer-events:none; max-width:46% } .wipe small.l { left:6px } .wipe small.r { right:6px }
footer { color:var(--dim); font-size:13px; padding:40px 0 60px }
@media print { nav, .controls { display:none } .scroll { max-height:none } }
)css";

const std::string_view kPageScript = R"js(
'use strict';
const NS = 'http://www.w3.org/2000/svg';
const el = (name, attrs, parent, text) => { const e = document.createElementNS(NS, name);
  for (const k in attrs) e.setAttribute(k, attrs[k]); if (text !== undefined) e.textContent = text;
  if (parent) parent.appendChild(e); return e; };
const good = v => typeof v === 'number' && isFinite(v);
const short = v => !good(v) ? '–' : v === 0 ? '0' : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? v.toExponential(1) : String(+v.toPrecision(3));
const rises = key => /psnr|ssim|speed|gain/.test(key);   // more is better
function front(points, up) {   // points that no other beats, by rising x
  const s = [...points].sort((a, b) => a.x - b.x || (up ? b.y - a.y : a.y - b.y)), out = [];
  for (const p of s) if (!out.length || (up ? p.y > out[out.length-1].y : p.y < out[out.length-1].y)) out.push(p);
  return out; }
function scale(values, log, low, high) {
  let a = Math.min(...values), b = Math.max(...values);
  if (log) { a = Math.log10(a); b = Math.log10(b); }
  if (!(b > a)) { a -= .5; b += .5; } const pad = (b - a) * .05; a -= pad; b += pad;
  const f = v => low + ((log ? Math.log10(v) : v) - a) / (b - a) * (high - low);
  const ticks = [];
  if (log) { for (let d = Math.floor(a); d <= b; d++) for (const m of b - a > 2 ? [1] : [1, 2, 5]) { const v = m * 10 ** d; if (Math.log10(v) >= a && Math.log10(v) <= b) ticks.push(v); } }
  else { const step = 10 ** Math.floor(Math.log10((b - a) / 3)), k = (b - a) / step > 12 ? 5 : (b - a) / step > 6 ? 2 : 1; for (let v = Math.ceil(a / (k * step)) * k * step; v <= b; v += k * step) ticks.push(+v.toPrecision(12)); }
  return { f, ticks }; }
const text = v => typeof v === 'string' && v !== '';
const hues = ['#0b6bcb', '#d1495b', '#2a9d5c', '#e0932b', '#8457c6', '#12a5b5', '#b4548f', '#7a8b2a', '#c7642c', '#5b6b7e', '#3f51b5', '#9c6b4f'];
// the colours of the values of a column; none where there is one value or there are too many
function palette(rows, key) {
  const names = key ? [...new Set(rows.map(r => r[key]).filter(text))] : [];
  return names.length > 1 && names.length <= hues.length ? new Map(names.map((n, i) => [n, hues[i]])) : new Map(); }
function legend(host, colours) {
  const key = document.createElement('div'); key.className = 'key';
  for (const [name, hue] of colours) { const s = document.createElement('span'), i = document.createElement('i'); i.style.borderColor = hue; s.append(i, name); key.append(s); }
  host.append(key); }
function chart(host, rows, xKey, yKey, series, colours) {
  host.textContent = '';
  const W = 420, H = 300, L = 54, R = 12, T = 8, B = 38;
  const svg = el('svg', { viewBox: `0 0 ${W} ${H}`, role: 'img', 'aria-label': `${yKey} over ${xKey}` }, host);
  const all = rows.map(r => ({ x: r[xKey], y: r[yKey], r })).filter(p => good(p.x) && good(p.y));
  if (!all.length) { el('text', { x: W / 2, y: H / 2, 'text-anchor': 'middle' }, svg, 'nothing to show'); return; }
  const logX = all.every(p => p.x > 0), logY = !/db|ssim/.test(yKey) && all.every(p => p.y > 0);
  const X = scale(all.map(p => p.x), logX, L, W - R), Y = scale(all.map(p => p.y), logY, H - B, T);
  for (const v of X.ticks) { el('line', { class: 'axis', x1: X.f(v), x2: X.f(v), y1: T, y2: H - B }, svg); el('text', { x: X.f(v), y: H - B + 14, 'text-anchor': 'middle' }, svg, short(v)); }
  for (const v of Y.ticks) { el('line', { class: 'axis', x1: L, x2: W - R, y1: Y.f(v), y2: Y.f(v) }, svg); el('text', { x: L - 6, y: Y.f(v) + 4, 'text-anchor': 'end' }, svg, short(v)); }
  el('text', { x: (L + W) / 2, y: H - 6, 'text-anchor': 'middle' }, svg, xKey);
  el('text', { transform: `translate(12 ${(H - B) / 2}) rotate(-90)`, 'text-anchor': 'middle' }, svg, yKey);
  const line = (pts, cls) => pts.length > 1 && el('path', { class: cls, d: 'M' + pts.map(p => X.f(p.x).toFixed(1) + ' ' + Y.f(p.y).toFixed(1)).join('L') }, svg);
  const uniform = all.filter(p => p.r.uniform === true), own = all.filter(p => p.r.uniform !== true);
  const best = front(own, rises(yKey));
  line(front(uniform, rises(yKey)), 'baseline');
  if (uniform.length) line(best, 'best');
  if (/latency|ranks/.test(xKey)) for (const [name, hue] of colours) {   // runs along x; the best of several there
    const runs = new Map(); for (const p of all) if (p.r[series] === name) { const o = runs.get(p.x); if (!o || (rises(yKey) ? p.y > o.y : p.y < o.y)) runs.set(p.x, p); }
    const path = line([...runs.values()].sort((a, b) => a.x - b.x), 'run'); if (path) path.style.stroke = hue; }
  for (const p of all) {
    const hue = colours.get(p.r[series]), c = el('circle', { cx: X.f(p.x).toFixed(1), cy: Y.f(p.y).toFixed(1), r: best.includes(p) && uniform.length ? 4 : 3.2, class: p.r.uniform === true ? 'u' : best.includes(p) && uniform.length ? 'f' : '' }, svg);
    if (hue) c.style.fill = hue;
    const name = Object.entries(p.r).filter(([k, v]) => text(v) && !/hash|picture/.test(k)).map(([, v]) => v).join(' · ');
    el('title', {}, c, `${name}\n${xKey} ${short(p.x)}\n${yKey} ${short(p.y)}`); } }
function choose(host, label, keys, value, then) {
  const l = document.createElement('label'); l.append(label); const s = document.createElement('select');
  for (const k of keys) { const o = document.createElement('option'); o.textContent = k; s.append(o); }
  s.value = value; s.onchange = () => then(s.value); l.append(s); host.append(l); return s; }
const numeric = rows => Object.keys(rows[0] || {}).filter(k => rows.some(r => good(r[k])));
for (const box of document.querySelectorAll('[data-charts]')) {
  const rows = JSON.parse(document.getElementById(box.dataset.charts).textContent), by = box.dataset.by;
  const keys = numeric(rows); if (keys.length < 2) continue;
  const groups = new Map(); for (const r of rows) { const k = by ? r[by] : ''; if (!groups.has(k)) groups.set(k, []); groups.get(k).push(r); }
  let x = keys.includes(box.dataset.x) ? box.dataset.x : keys[0], y = keys.includes(box.dataset.y) ? box.dataset.y : keys[keys.length - 1];
  const controls = document.createElement('div'); controls.className = 'controls'; box.append(controls);
  const series = box.dataset.series, colours = palette(rows, series); if (colours.size) legend(box, colours);
  const grid = document.createElement('div'); grid.className = 'grid'; box.append(grid);
  const draw = () => { grid.textContent = ''; for (const [name, list] of groups) { const f = document.createElement('figure'); if (name) { const c = document.createElement('figcaption'); c.textContent = name; f.append(c); } const host = document.createElement('div'); f.append(host); grid.append(f); chart(host, list, x, y, series, colours); } };
  choose(controls, 'show', keys, y, v => { y = v; draw(); }); choose(controls, 'over', keys, x, v => { x = v; draw(); }); draw(); }
for (const box of document.querySelectorAll('[data-wipe]')) {
  const pictures = JSON.parse(document.getElementById(box.dataset.wipe).textContent), names = Object.keys(pictures);
  const controls = document.createElement('div'); controls.className = 'controls';
  const frame = document.createElement('div'); frame.className = 'wipe';
  frame.innerHTML = '<img alt=""><img alt="" class="over"><div class="bar"></div><small class="l"></small><small class="r"></small><input type="range" min="0" max="1000" value="500" aria-label="wipe between the two pictures">';
  const [left, right] = frame.querySelectorAll('img'), bar = frame.querySelector('.bar'), input = frame.querySelector('input'), [ln, rn] = frame.querySelectorAll('small');
  const wipe = () => { const p = input.value / 10; right.style.clipPath = `inset(0 0 0 ${p}%)`; bar.style.left = p + '%'; };
  const show = (img, tag, name) => { img.src = 'data:image/png;base64,' + pictures[name]; tag.textContent = name; };
  input.oninput = wipe;
  const b = names.includes('scale=1') ? 'scale=1' : names[names.length - 1];
  choose(controls, 'left', names, names[0], v => show(left, ln, v)); choose(controls, 'right', names, b, v => show(right, rn, v));
  box.append(controls, frame); show(left, ln, names[0]); show(right, rn, b); wipe(); }
for (const th of document.querySelectorAll('th')) th.onclick = () => {
  const table = th.closest('table'), body = table.tBodies[0], i = [...th.parentNode.children].indexOf(th), down = th.dataset.down !== '1'; th.dataset.down = down ? '1' : '0';
  const value = r => { const t = r.children[i].textContent, n = parseFloat(t); return isNaN(n) ? t : n; };
  [...body.rows].sort((p, q) => { const a = value(p), b = value(q); return (a < b ? -1 : a > b ? 1 : 0) * (down ? 1 : -1); }).forEach(r => body.append(r)); };
)js";

}  // namespace macula::bench
