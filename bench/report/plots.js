"use strict";
// Draws plots. All texts become text nodes: nothing in the data is markup.

const markCount = 5;
const colourCount = 8;

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function shape(name, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

// Numbers as people read them: 12.3 M, 450, 0.0321.
function short(value) {
  const size = Math.abs(value);
  if (size === 0) return "0";
  for (const [unit, letter] of [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e4, "k"]]) {
    if (size >= unit) {
      const scale = letter === "k" ? 1e3 : unit;
      return `${Number((value / scale).toPrecision(3))} ${letter}`;
    }
  }
  if (size < 1e-4) return value.toExponential(2);
  return String(Number(value.toPrecision(size >= 1000 ? 4 : 3)));
}

// --- Axes ---------------------------------------------------------------------------------------

function linearTicks(most, count) {
  const rough = most / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((s) => s >= rough);
  const ticks = [];
  for (let i = 0; i * step <= most * 1.0001; ++i) ticks.push(i * step);
  return ticks;
}

function logTicks(least, most) {
  const few = Math.log10(most / least) < 2;
  const ticks = [];
  for (let power = Math.floor(Math.log10(least)); 10 ** power <= most; ++power) {
    for (const n of few ? [1, 2, 5] : [1]) {
      const tick = n * 10 ** power;
      if (tick >= least * 0.999 && tick <= most * 1.001) ticks.push(tick);
    }
  }
  return ticks;
}

// Maps values to [from, to] in pixels.
function scaleOf(least, most, log, from, to) {
  const at = log ? Math.log : (value) => value;
  const span = at(most) - at(least) || 1;
  return (value) => from + ((at(value) - at(least)) / span) * (to - from);
}

// Values of all lines that are shown, intervals included.
function extent(plot) {
  const values = plot.lines.flat().flatMap((p) => [p.y, p.low ?? p.y, p.high ?? p.y]);
  const most = Math.max(...values, 1e-12);
  if (!plot.logY) return [Math.min(0, ...values), most];
  const positive = values.filter((value) => value > 0);
  return [Math.min(...positive) / 1.15, most * 1.15];
}

// Those of `places` whose labels, `gap` apart at least, do not touch.
function apart(places, at, gap) {
  const kept = [];
  for (const place of places) {
    if (kept.length === 0 || Math.abs(at(place) - at(kept.at(-1))) >= gap) kept.push(place);
  }
  return kept;
}

// --- Series -------------------------------------------------------------------------------------

const markPaths = [
  "M-3.4 0A3.4 3.4 0 1 0 3.4 0A3.4 3.4 0 1 0 -3.4 0Z",
  "M-3.1 -3.1H3.1V3.1H-3.1Z",
  "M0 -4L3.8 2.9H-3.8Z",
  "M0 -4.3L4.1 0L0 4.3L-4.1 0Z",
  "M0 4L3.8 -2.9H-3.8Z",
];

function mark(series, x, y) {
  const path = markPaths[(series.colour + Math.floor(series.colour / colourCount)) % markCount];
  return shape("path", { class: "mark", d: path, transform: `translate(${x} ${y})` });
}

function seriesGroup(series, index) {
  return shape("g", {
    class: `series${series.simulated ? " simulated" : ""}${series.baseline ? " baseline" : ""}`,
    style: `--c: var(--${series.baseline ? "baseline" : `c${series.colour % colourCount}`})`,
    "data-series": index,
  });
}

function swatch(series) {
  const group = seriesGroup(series, -1);
  group.append(shape("path", { class: "line", d: "M0 7H24" }), mark(series, 12, 7));
  return shape("svg", { width: 24, height: 14, viewBox: "0 0 24 14", "aria-hidden": true }, group);
}

function clipped(text, room) {
  const most = Math.max(3, Math.floor(room / 6.3));
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

function label(text, x, y, attributes = {}) {
  return shape("text", { x, y, ...attributes }, text);
}

// --- Plots of lines -----------------------------------------------------------------------------

function drawLines(plot, panel, shown, width) {
  const wide = width > 620;
  const height = wide ? 380 : 250;
  const direct = wide && shown.size <= 10;
  const area = { left: 56, right: width - (direct ? 170 : 14), top: 12, bottom: height - 40 };
  const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svg.append(shape("title", {}, plot.title));
  const xs = [...new Set(plot.lines.flat().map((p) => p.x))].sort((a, b) => a - b);
  const named = plot.categories.length > 0;
  const x = scaleOf(plot.logX || named ? xs[0] : Math.min(0, xs[0]), xs.at(-1), plot.logX,
    area.left + 12, area.right - 12);
  const [least, most] = extent(plot);
  const y = scaleOf(least, plot.logY ? most : most * 1.05, plot.logY, area.bottom, area.top);

  const ticks = plot.logY ? logTicks(least, most) : linearTicks(most, wide ? 6 : 4);
  for (const tick of apart(ticks, y, 16)) {
    svg.append(
      shape("path", { class: "grid", d: `M${area.left} ${y(tick)}H${area.right}` }),
      label(short(tick), area.left - 7, y(tick) + 4, { "text-anchor": "end" }));
  }
  for (const place of apart(xs, x, named ? 34 : 30)) {
    svg.append(
      shape("path", { class: "axis", d: `M${x(place)} ${area.bottom}v5` }),
      label(named ? plot.categories[place] : short(place), x(place), area.bottom + 18,
        { "text-anchor": "middle" }));
  }
  svg.append(
    shape("path", { class: "axis", d: `M${area.left} ${area.bottom}H${area.right}` }),
    label(plot.xTitle + (plot.logX ? ", logarithmic" : ""), area.right, height - 5,
      { "text-anchor": "end" }));
  if (plot.logY) svg.append(label("logarithmic", area.left + 4, area.top - 2));

  for (const level of plot.marks) {
    const place = x(level.x);
    svg.append(
      shape("path", { class: "level", d: `M${place} ${area.top}V${area.bottom}` }),
      label(clipped(level.name, area.bottom - area.top), place - 3, area.bottom - 4,
        { class: "level", transform: `rotate(-90 ${place - 3} ${area.bottom - 4})` }));
  }

  const points = [];
  const ends = [];
  plot.lines.forEach((line, index) => {
    if (!shown.has(index) || line.length === 0) return;
    const series = panel.series[index];
    const group = seriesGroup(series, index);
    const bounded = line.filter((p) => p.low !== null && p.high !== null);
    // An interval may reach below a logarithmic axis.
    const inside = (value) => Math.min(area.bottom, y(plot.logY ? Math.max(value, least) : value));
    if (bounded.length > 1) {
      const upper = bounded.map((p) => `${x(p.x)} ${inside(p.high)}`);
      const lower = bounded.map((p) => `${x(p.x)} ${inside(p.low)}`).reverse();
      group.append(shape("path", { class: "band", d: `M${[...upper, ...lower].join("L")}Z` }));
    }
    const path = line.map((p) => `${x(p.x)} ${y(p.y)}`).join("L");
    group.append(shape("path", { class: "line", d: `M${path}` }));
    for (const p of line) {
      if (p.low !== null && p.high !== null) {
        const bar = `M${x(p.x)} ${inside(p.low)}V${inside(p.high)}`;
        group.append(shape("path", { class: "bar", d: bar }));
      }
      group.append(mark(series, x(p.x), y(p.y)));
      points.push({ px: x(p.x), py: y(p.y), series: index, point: p });
    }
    svg.append(group);
    ends.push({ group, name: series.name, px: x(line.at(-1).x), py: y(line.at(-1).y) });
  });
  if (direct) labelEnds(ends, area);
  return { svg, points };
}

// Names at the ends of the lines, spread so that they do not overlap.
function labelEnds(ends, area) {
  const gap = 15;
  ends.sort((a, b) => a.py - b.py);
  let last = area.top - gap;
  for (const end of ends) last = end.at = Math.max(end.py, last + gap);
  let next = area.bottom + gap;
  for (const end of ends.toReversed()) next = end.at = Math.min(end.at, next - gap);
  for (const end of ends) {
    const leader = `M${end.px + 6} ${end.py}L${area.right + 8} ${end.at}`;
    end.group.append(
      shape("path", { class: "leader", d: leader }),
      label(clipped(end.name, 155), area.right + 12, end.at + 4));
  }
}

// --- Plots of one value per series --------------------------------------------------------------

function drawDots(plot, panel, shown, width) {
  const rows = plot.lines
    .map((line, index) => ({ index, point: line[0] }))
    .filter((row) => row.point !== undefined && shown.has(row.index));
  if (panel.family !== "micro") rows.sort((a, b) => b.point.y - a.point.y);
  const step = 22;
  const height = rows.length * step + 44;
  const longest = Math.max(0, ...rows.map((row) => panel.series[row.index].name.length));
  const left = Math.min(longest * 6.3 + 14, width * 0.38);
  const right = width - 58;
  const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svg.append(shape("title", {}, plot.title));
  const bottom = height - 38;
  const [least, most] = extent(plot);
  const x = scaleOf(least, most, plot.logY, left + 8, right);
  const ticks = plot.logY ? logTicks(least, most) : linearTicks(most, width > 620 ? 6 : 3);
  for (const tick of apart(ticks, x, 44)) {
    svg.append(
      shape("path", { class: "grid", d: `M${x(tick)} 2V${bottom}` }),
      label(short(tick), x(tick), bottom + 16, { "text-anchor": "middle" }));
  }
  const unit = plot.title + (plot.logY ? ", logarithmic" : "");
  svg.append(label(clipped(unit, width), width - 4, height - 5, { "text-anchor": "end" }));

  const points = [];
  rows.forEach(({ index, point }, row) => {
    const series = panel.series[index];
    const y = row * step + 14;
    const group = seriesGroup(series, index);
    if (point.low !== null && point.high !== null) {
      const low = x(plot.logY ? Math.max(point.low, least) : point.low);
      const bar = `M${low} ${y}H${x(point.high)}m0 -4v8M${low} ${y - 4}v8`;
      group.append(shape("path", { class: "bar", d: bar }));
    }
    group.append(
      mark(series, x(point.y), y),
      label(clipped(series.name, left - 8), left - 4, y + 4, { "text-anchor": "end" }),
      label(short(point.y), width - 4, y + 4, { class: "value", "text-anchor": "end" }));
    svg.append(group);
    points.push({ px: x(point.y), py: y, series: index, point });
  });
  return { svg, points, byRow: true };
}

// --- Hover --------------------------------------------------------------------------------------

const tip = document.getElementById("tip");

function showTip(event, plot, panel, near) {
  const { point } = near;
  const series = panel.series[near.series];
  const lines = [`${plot.title}: ${short(point.y)}`];
  if (!plot.dots) {
    const at = plot.categories.length > 0 ? plot.categories[point.x] : short(point.x);
    lines.push(`${plot.xTitle}: ${at}`);
  }
  if (point.low !== null && point.high !== null) {
    lines.push(`interval: ${short(point.low)} to ${short(point.high)}`);
  }
  if (point.samples.length > 0) {
    const few = point.samples.slice(0, 12).map(short).join(", ");
    const more = point.samples.length > 12 ? ` and ${point.samples.length - 12} more` : "";
    lines.push(`${point.samples.length} samples: ${few}${more}`);
  }
  lines.push(series.simulated ? "simulated" : "measured");
  tip.replaceChildren(element("strong", {}, series.name),
    ...lines.map((line) => element("div", {}, line)));
  tip.hidden = false;
  const room = document.documentElement.clientWidth - tip.offsetWidth - 8;
  tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, room))}px`;
  const above = event.clientY - tip.offsetHeight - 12;
  tip.style.top = `${above > 4 ? above : event.clientY + 16}px`;
}

function watchPointer(drawn, plot, panel) {
  const { svg, points, byRow } = drawn;
  const leave = () => {
    tip.hidden = true;
    svg.classList.remove("pointed");
    svg.querySelectorAll(".near").forEach((group) => group.classList.remove("near"));
  };
  const move = (event) => {
    const box = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / box.width;
    const px = (event.clientX - box.left) * scale;
    const py = (event.clientY - box.top) * scale;
    const away = (p) => (byRow ? Math.abs(p.py - py) : Math.hypot(p.px - px, p.py - py));
    leave();
    const near = points.reduce((a, b) => (a !== null && away(a) <= away(b) ? a : b), null);
    if (near === null || away(near) > (byRow ? 11 : 48)) return;
    svg.classList.add("pointed");
    svg.querySelector(`[data-series="${near.series}"]`).classList.add("near");
    showTip(event, plot, panel, near);
  };
  svg.addEventListener("pointermove", move);
  svg.addEventListener("pointerdown", move);
  svg.addEventListener("pointerleave", leave);
}
