// SPDX-License-Identifier: MIT
// The tables. Cells keep their value, by which columns are sorted; what has none stands last.
"use strict";

const element = (tag, text, classes) => {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (classes) node.className = classes;
  return node;
};

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
  const decades = study.choices[state.error][state.speed].decades;
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of([element("th", "error at most"), element("th", speed.label, "number"), element("th", "error", "number"),
    element("th", "series"), element("th", "settings"),
    ...study.series.map((s) => element("th", s.name, "number"))]));
  const best_of = (series, limit) => {
    const fit = series.points.filter((n) => study.points[n].status === "done" && error.values[n] !== null &&
      error.values[n] <= limit && speed.values[n] !== null);
    return fit.reduce((best, n) => (best === null || (speed.less ? speed.values[n] < speed.values[best] : speed.values[n] > speed.values[best]) ? n : best), null);
  };
  for (const [exponent, n] of decades) {
    const series = series_of_point[n];
    const name = element("td", series.name, "name");
    const swatch = element("span", "", "swatch");
    swatch.style.background = series.colour;
    name.prepend(swatch);
    const limit = exponent === null ? 0 : Number("1e" + exponent);
    const row = row_of([element("th", exponent === null ? "0" : power_of_ten(exponent)), element("td", number(speed.values[n], 3), "number best"),
      element("td", number(error.values[n], 3), "number"), name, element("td", settings_text(study.points[n]), "settings"),
      ...study.series.map((s) => {
        const best = best_of(s, limit);
        return element("td", best === null ? "–" : number(speed.values[best], 3), s === series ? "number best" : "number");
      })]);
    row.dataset.point = n;
    table.tBodies[0].append(row);
  }
  if (!decades.length) table.tBodies[0].append(row_of([element("td", "No point has both an error and a speed.")]));
}

// name, value(n), text(n) (default: of the value), whether a number.
function point_columns() {
  const keys = (part) => [...new Set(study.points.flatMap((p) => p[part].map(([key]) => key)))];
  const change = (part, key) => ({name: key, value: (n) => {
    const found = study.points[n][part].find(([k]) => k === key);
    if (!found) return null;
    const text = found[1].replace(/^"(.*)"$/, "$1"), as_number = Number(text);
    return text !== "" && Number.isFinite(as_number) ? as_number : text;
  }});
  const of = (name, field, is_number) => ({name, value: (n) => study.points[n][field], number: is_number});
  return [
    {name: "point", value: (n) => n + 1, number: true}, of("engine", "engine"), of("arithmetic", "arithmetic"),
    ...(study.points.some((p) => p.machine) ? [of("machine", "machine")] : []),
    of("status", "status"), of("threads", "threads", true), of("integrator", "integrator"),
    ...keys("scene").map((key) => change("scene", key)), ...keys("arch").map((key) => change("arch", key)),
    of("time step, s", "dt", true),
    ...study.errors.map((e) => ({name: e.label, value: (n) => e.values[n], number: true})),
    ...study.figure_names.map((name, k) => ({name: name + (study.figure_units[k] ? ", " + study.figure_units[k] : ""),
      value: (n) => study.points[n].figures[k] ?? null, number: true})),
    ...study.speeds.map((s) => ({name: s.label, value: (n) => s.values[n], number: true})),
    of("spread of the repeats", "spread", true), of("bits of a record", "halo_bits", true), of("bits of the tables", "table_bits", true),
    of("particles", "particles", true), of("steps", "steps", true), of("why", "why"),
  ];
}

function compare_values(a, b) {
  const none_a = a === null || a === undefined || a === "", none_b = b === null || b === undefined || b === "";
  if (none_a || none_b) return none_a && none_b ? 0 : none_a ? Infinity : -Infinity;  // last, either way
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a) < String(b) ? -1 : String(a) > String(b) ? 1 : 0;
}

function fill_points() {
  const table = document.getElementById("points");
  const columns = point_columns();
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of(columns.map((column, c) => {
    const head = element("th", undefined, column.number ? "number" : "");
    const button = element("button", column.name);
    button.type = "button";
    button.addEventListener("click", () => sort_points(c));
    head.append(button);
    return head;
  })));
  const rows = study.points.map((point, n) => {
    const row = row_of(columns.map((column) => {
      const value = column.value(n);
      const kind = column.name === "status" && value !== "done" ? value : column.name === "why" ? "why" : "name";
      return element("td", column.name === "why" ? value : typeof value === "number" ? number(value) : value === null || value === "" ? "–" : value,
        column.number || typeof value === "number" ? "number" : kind);
    }));
    row.dataset.point = n;
    return row;
  });
  table.tBodies[0].append(...rows);

  function sort_points(c) {
    const heads = table.tHead.rows[0].cells;
    const down = heads[c].getAttribute("aria-sort") === "ascending";
    for (const head of heads) head.removeAttribute("aria-sort");
    heads[c].setAttribute("aria-sort", down ? "descending" : "ascending");
    const value = columns[c].value;
    const order = [...rows].sort((a, b) => {
      const n = Number(a.dataset.point), m = Number(b.dataset.point);
      const d = compare_values(value(n), value(m));
      return d === 0 || Number.isNaN(d) ? n - m : Number.isFinite(d) && down ? -d : d;
    });
    table.tBodies[0].replaceChildren(...order);
  }

  const filter = document.getElementById("filter"), status = document.getElementById("status");
  const update = () => {
    let count = 0;
    for (const row of rows) {
      const point = study.points[Number(row.dataset.point)];
      const text = settings_of(point).flat().concat(point.machine, point.why).join(" ").toLowerCase();
      row.hidden = (status.value !== "" && point.status !== status.value) || !text.includes(filter.value.toLowerCase());
      if (!row.hidden) ++count;
    }
    document.getElementById("shown").textContent = `${count} of ${rows.length}`;
  };
  filter.addEventListener("input", update);
  status.addEventListener("change", update);
  update();
}

// Shows a point's row.
function choose(n) {
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
