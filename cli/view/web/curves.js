// SPDX-License-Identifier: MIT
// What probes read, as small charts over time with a mark at the frame's time. Drawn as SVG.
import {element, number, ticks} from "./format.js";

const kWide = 320, kHigh = 150, kLeft = 58, kRight = 8, kTop = 8, kBottom = 24;
const svg = (name, attributes, text) => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
};

// So many that neighbours among ticks differ.
function digits_of(lines) {
  if (lines.length < 2) return 3;
  const largest = Math.max(...lines.map(Math.abs));
  return Math.min(9, Math.max(3, Math.ceil(Math.log10(largest / (lines[1] - lines[0]))) + 1));
}

// Between the finite numbers of a list; a flat one has room about it.
function span(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) if (Number.isFinite(value)) low = Math.min(low, value), high = Math.max(high, value);
  if (low > high) return [0, 1];
  if (low === high) return low === 0 ? [-1, 1] : [low - Math.abs(low) / 2, high + Math.abs(high) / 2];
  return [low, high];
}

export class Chart {
  constructor(curve, dt, unit_of_time, reduced) {
    this.curve = curve;
    this.dt = dt;
    this.unit = unit_of_time;
    this.figure = element("figure", undefined, "curve");
    const caption = element("figcaption", curve.name + (curve.unit && curve.unit !== "1" && !reduced ? ", " + curve.unit : ""));
    this.reading = element("span", "", "reading");
    caption.append(" ", this.reading);
    this.figure.append(caption);
    this.draw();
  }
  // Once more where the curve has grown.
  draw() {
    this.x = this.curve.step.map((step) => step * this.dt);
    this.picture?.remove();
    this.picture = this.drawn(this.unit);
    this.figure.append(this.picture);
  }
  drawn(unit) {
    const [x0, x1] = span(this.x), [y0, y1] = span(this.curve.value);
    this.to_x = (x) => kLeft + ((x - x0) / (x1 - x0)) * (kWide - kLeft - kRight);
    const to_y = (y) => kHigh - kBottom - ((y - y0) / (y1 - y0)) * (kHigh - kTop - kBottom);
    const picture = svg("svg", {viewBox: `0 0 ${kWide} ${kHigh}`, role: "img", "aria-label": this.curve.name});
    const lines = ticks(y0, y1), digits = digits_of(lines);
    for (const y of lines)
      picture.append(svg("line", {x1: kLeft, x2: kWide - kRight, y1: to_y(y), y2: to_y(y), class: "grid"}),
        svg("text", {x: kLeft - 4, y: to_y(y) + 3.5, "text-anchor": "end"}, number(y, digits)));
    const times = ticks(x0, x1), every = Math.ceil(times.length / 4);
    times.filter((_, k) => k % every === 0).forEach((x) => picture.append(
      svg("text", {x: Math.min(this.to_x(x), kWide - 22), y: kHigh - 8, "text-anchor": "middle"}, number(x, 3) + (x === 0 ? " " + unit : ""))));
    let path = "", pen = "M";
    this.x.forEach((x, k) => {
      const y = this.curve.value[k];
      if (!Number.isFinite(y)) return void (pen = "M");
      path += `${pen}${this.to_x(x).toFixed(1)} ${to_y(y).toFixed(1)}`;
      pen = "L";
    });
    picture.append(svg("path", {d: path, class: "line"}));
    if (this.x.length === 1) picture.append(svg("circle", {cx: this.to_x(this.x[0]), cy: to_y(this.curve.value[0]), r: 2.5, class: "dot"}));
    this.mark = svg("line", {y1: kTop, y2: kHigh - kBottom, class: "mark"});
    picture.append(this.mark);
    return picture;
  }
  // The last reading at or before the frame.
  at(step) {
    let k = this.curve.step.length - 1;
    while (k > 0 && this.curve.step[k] > step) --k;
    const x = this.to_x(Math.min(Math.max(step * this.dt, this.x[0]), this.x[this.x.length - 1]));
    this.mark.setAttribute("x1", x), this.mark.setAttribute("x2", x);
    this.reading.textContent = number(this.curve.value[k], 5);
  }
}

export function charts_of(story, place) {
  const {head} = story, unit = head.static ? "steps" : head.reduced ? "" : "s";
  const charts = story.curves.filter((curve) => curve.step.length > 0).map((curve) => new Chart(curve, head.static ? 1 : head.dt, unit, head.reduced));
  place.replaceChildren(...charts.map((chart) => chart.figure));
  return charts;
}

const kMost = 4096;  // readings of a curve that goes on

// What the frames that came have read goes behind the story's curves. Of very many readings every second one goes.
export function grow(curves, frames) {
  for (const {read} of frames)
    for (const [k, {name, unit, step, value}] of (read || []).entries()) {
      if (k === curves.length) curves.push({name, unit, step: [], value: []});
      const curve = curves[k];
      curve.step.push(...step), curve.value.push(...value);
      if (curve.step.length <= 2 * kMost) continue;
      const last = curve.step.length - 1;
      for (const list of ["step", "value"]) curve[list] = curve[list].filter((_, at) => at % 2 === 0 || at === last);
    }
}
