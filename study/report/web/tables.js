// SPDX-License-Identifier: MIT
// The tables. Cells keep their value, by which columns are sorted; what has none stands last.
"use strict";

const element = (tag, text, classes) => {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (classes) node.className = classes;
  return node;
};

// A name of a column, which may break behind a dot or an underscore.
function broken_name(name) {
  const parts = name.split(/(?<=[._])/);
  return parts.flatMap((part, k) => (k + 1 < parts.length ? [part, element("wbr")] : [part]));
}

function row_of(cells) {
  const row = element("tr");
  for (const cell of cells) row.append(cell);
  return row;
}

function fill_decades() {
  const table = document.getElementById("decades");
  table.replaceChildren();
  const error = study.errors[state.error], speed = study.speeds[state.speed];
  if (!error || !speed) return;
  const decades = study.decades[state.error][state.speed];
  const compared = study.series.length > 1 ? study.series : [];  // one series is the whole
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of([element("th", "error at most"), element("th", speed.label, "number"), element("th", "error", "number"),
    element("th", "settings", "settings"), element("th", "series", "by"),
    ...compared.map((s) => element("th", s.name, "number of"))]));
  const best_of = (series, limit) => {
    const fit = series.points.filter((n) => study.points[n].status === "done" && error.values[n] !== null &&
      error.values[n] <= limit && speed.values[n] !== null);
    return fit.reduce((best, n) => (best === null || (speed.less ? speed.values[n] < speed.values[best] : speed.values[n] > speed.values[best]) ? n : best), null);
  };
  for (const [exponent, n] of decades) {
    const series = series_of_point[n];
    const name = element("td", series.name, "name by");
    const swatch = element("span", "", "swatch");
    swatch.style.background = series.colour;
    name.prepend(swatch);
    const limit = exponent === null ? 0 : Number("1e" + exponent);
    const row = row_of([element("th", exponent === null ? "0" : power_of_ten(exponent)), element("td", number(speed.values[n], 3), "number best"),
      element("td", number(error.values[n], 3), "number"), element("td", settings_text(study.points[n]), "settings"), name,
      ...compared.map((s) => {
        const best = best_of(s, limit);
        const cell = element("td", best === null ? "–" : number(speed.values[best], 3), s === series ? "number of best" : "number of");
        cell.dataset.series = s.name;  // which a narrow screen shows beside the number
        return cell;
      })]);
    row.dataset.point = n;
    table.tBodies[0].append(row);
  }
  if (!decades.length) table.tBodies[0].append(row_of([element("td", "No point has both an error and a speed.")]));
}

// name, value(n), whether a number, whether a key of scene or arch, whether it stands in any case. First what is compared, then the settings, then what else was measured.
function all_columns() {
  const keys = (part) => [...new Set(study.points.flatMap((p) => p[part].map(([key]) => key)))];
  const change = (part, key) => ({name: key, setting: true, value: (n) => {
    const found = study.points[n][part].find(([k]) => k === key);
    if (!found) return null;
    const text = found[1].replace(/^"(.*)"$/, "$1"), as_number = Number(text);
    return text !== "" && Number.isFinite(as_number) ? as_number : text;
  }});
  const of = (name, field, is_number) => ({name, value: (n) => study.points[n][field], number: is_number});
  const measures = (all) => all.map((m) => ({name: m.label, value: (n) => m.values[n], number: true}));
  const chosen = [study.errors[state.error], study.speeds[state.speed]].filter((m) => m);
  const others = (all) => measures(all.filter((m) => !chosen.includes(m)));
  return [
    {name: "point", value: (n) => n + 1, number: true, always: true}, ...measures(chosen).map((column) => ({...column, always: true})),
    of("engine", "engine"), of("arithmetic", "arithmetic"),
    ...keys("scene").map((key) => change("scene", key)), ...keys("arch").map((key) => change("arch", key)),
    of("threads", "threads", true), of("integrator", "integrator"), of("machine", "machine"), of("status", "status"),
    of("time step, s", "dt", true),
    ...others(study.errors),
    ...study.figure_names.map((name, k) => ({name: name + (study.figure_units[k] ? ", " + study.figure_units[k] : ""),
      value: (n) => study.points[n].figures[k] ?? null, number: true})),
    ...others(study.speeds),
    of("spread of the repeats", "spread", true), of("bits of a record", "halo_bits", true), of("bits of the tables", "table_bits", true),
    of("particles", "particles", true), of("steps", "steps", true), of("why", "why"),
  ];
}

const is_none = (value) => value === null || value === undefined || value === "";
const shown_value = (value) => (is_none(value) ? "–" : typeof value === "number" ? number(value) : value);

// Columns in which points differ; `same` tells the others, but for those that no point has.
function point_columns() {
  const columns = [], same = [];
  for (const column of all_columns()) {
    const values = study.points.map((_, n) => column.value(n));
    if (column.setting) column.number = values.every((value) => value === null || typeof value === "number");
    if (column.always || !all_equal(values.map((value) => (is_none(value) ? null : value)))) columns.push(column);
    else if (!is_none(values[0])) same.push(`${column.name} = ${shown_value(values[0])}`);
  }
  return {columns, same: same.length ? `All points have: ${same.join("; ")}.` : ""};
}

function compare_values(a, b) {
  const none_a = is_none(a), none_b = is_none(b);
  if (none_a || none_b) return none_a && none_b ? 0 : none_a ? Infinity : -Infinity;  // last, either way
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a) < String(b) ? -1 : String(a) > String(b) ? 1 : 0;
}

// Stands in the order in which the reader sorted it last.
function fill_points() {
  const table = document.getElementById("points");
  const {columns, same} = point_columns();
  document.getElementById("same").textContent = same;
  table.replaceChildren(element("thead"), element("tbody"));
  table.tHead.append(row_of(columns.map((column) => {
    const head = element("th", undefined, (column.number ? "number" : "") + (column.setting ? " setting" : ""));
    const button = element("button");
    button.append(...broken_name(column.name));
    button.type = "button";
    button.addEventListener("click", () => {
      state.down = state.sorted === column.name && !state.down;
      state.sorted = column.name;
      sort_points();
    });
    head.append(button);
    return head;
  })));
  table.tBodies[0].append(...study.points.map((point, n) => {
    const row = row_of(columns.map((column) => {
      const value = column.value(n);
      const kind = column.name === "status" && value !== "done" ? value : column.name === "why" ? "why" : "name";
      return element("td", column.name === "why" ? value : shown_value(value), column.number || typeof value === "number" ? "number" : kind);
    }));
    row.dataset.point = n;
    row.classList.toggle("chosen", n === state.chosen);
    return row;
  }));

  function sort_points() {
    const by = columns.findIndex((column) => column.name === state.sorted);
    if (by < 0) return;
    for (const head of table.tHead.rows[0].cells) head.removeAttribute("aria-sort");
    table.tHead.rows[0].cells[by].setAttribute("aria-sort", state.down ? "descending" : "ascending");
    const order = [...table.tBodies[0].rows].sort((a, b) => {
      const n = Number(a.dataset.point), m = Number(b.dataset.point);
      const d = compare_values(columns[by].value(n), columns[by].value(m));
      return d === 0 || Number.isNaN(d) ? n - m : Number.isFinite(d) && state.down ? -d : d;
    });
    table.tBodies[0].replaceChildren(...order);
  }
  sort_points();
  filter_points();
}

// Whether the reader's filter lets a point through.
function is_shown(n) {
  const point = study.points[n], word = document.getElementById("filter").value.toLowerCase();
  const status = document.getElementById("status").value;
  const text = settings_of(point).flat().concat(point.machine, point.why).join(" ").toLowerCase();
  return (status === "" || point.status === status) && text.includes(word);
}

function filter_points() {
  const rows = [...document.getElementById("points").tBodies[0].rows];
  for (const row of rows) row.hidden = !is_shown(Number(row.dataset.point));
  document.getElementById("shown").textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`;
}

// Shows a point's row.
function choose(n) {
  state.chosen = n;
  for (const row of document.querySelectorAll("#points tr.chosen")) row.classList.remove("chosen");
  const row = document.querySelector(`#points tr[data-point="${n}"]`);
  row.hidden = false;
  row.classList.add("chosen");
  row.scrollIntoView({block: "center"});
}

function fill_rungs() {
  const table = document.getElementById("rungs"), rungs = study.truth.rungs;
  if (!rungs.length) return;
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of(["rung", "time step, s", "cutoff, m", "trajectory from the rung before, pitches", "largest change of a figure",
    ...study.figure_names.map((name, k) => name + (study.figure_units[k] ? ", " + study.figure_units[k] : ""))].map((name) => element("th", name, "number"))));
  rungs.forEach((rung, k) => table.tBodies[0].append(row_of([k + 1, rung.dt, rung.cutoff, rung.trajectory, rung.change, ...rung.figures]
    .map((value, c) => element("td", c < 5 ? number(value) : number(value, 7), "number")))));
}
