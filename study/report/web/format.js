// SPDX-License-Identifier: MIT
// Numbers and settings as people read them.
"use strict";

const study = JSON.parse(document.getElementById("data").textContent);

const superscript = (n) => String(n).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
const power_of_ten = (n) => (n === 0 ? "1" : n === 1 ? "10" : "10" + superscript(n));

// Four significant digits: 0.01234, 1.234·10⁻⁷; "–" where there is none.
function number(x, digits = 4) {
  if (x === null || x === undefined) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e-3 && size < 1e6) return String(Number(x.toPrecision(digits)));
  const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
  return Number(mantissa) + "·10" + superscript(Number(exponent));
}

const escape_html = (text) => String(text).replace(/[<>&"]/g, (c) => ({"<": "&lt;", ">": "&gt;", "&": "&amp;", '"': "&quot;"})[c]);

for (const {x, y} of study.charts) for (const axis of [x, y]) axis.values = study.columns[axis.column];
const series_of_point = [];
for (const series of study.series) for (const n of series.points) series_of_point[n] = series;

// [name, value] of all that was set.
function settings_of(point) {
  const rows = [["engine", point.engine + ", " + point.arithmetic]];
  if (point.arithmetic !== "fixed") rows.push(["integrator", point.integrator]);
  if (point.threads !== null) rows.push(["threads", point.threads]);
  return rows.concat(point.scene, point.arch);
}

// Whether the values of all points are one; of one point nothing is worth folding.
const all_equal = (values) => values.length > 1 && values.every((value) => value === values[0]);
// Settings that differ between points: the others tell nothing of one.
const differs = (() => {
  const all = study.points.map((point) => new Map(settings_of(point)));
  const names = new Set(all.flatMap((settings) => [...settings.keys()]));
  return new Set([...names].filter((name) => !all_equal(all.map((settings) => settings.get(name)))));
})();
const settings_text = (point) =>
  settings_of(point).slice(1).filter(([name]) => differs.has(name)).map(([name, value]) => name + " " + value).join("; ") || "–";

// What a mark tells.
function tip(n) {
  const point = study.points[n];
  const error = study.errors[state.error], speed = study.speeds[state.speed];
  const rows = settings_of(point);
  if (point.machine) rows.push(["machine", point.machine]);
  rows.push(["time step, s", number(point.dt)], ["steps", point.steps]);
  if (error) rows.push([error.label, number(error.values[n])]);
  if (speed) rows.push([speed.label, number(speed.values[n])]);
  if (speed && speed.id !== "cost" && point.spread !== null)
    rows.push(["spread of " + point.repeats + " repeats", number(100 * point.spread, 2) + " %"]);
  if (point.status !== "done") rows.push([point.status, point.why]);
  return `<div class="tip"><b>Point ${n + 1}</b><table>` +
    rows.map(([name, value]) => `<tr><th>${escape_html(name)}</th><td>${escape_html(value)}</td></tr>`).join("") + "</table></div>";
}
