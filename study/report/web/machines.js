// SPDX-License-Identifier: MIT
// The page of a study of machines: charts, and a table of all.
"use strict";

const state = {error: null, speed: null, sorted: -1, down: false};

// study.head: names of columns; study.rows: their cells, numbers as such.
function fill_machines() {
  const table = document.getElementById("points");
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of(study.head.map((name, column) => {
    const head = element("th", undefined, study.rows.some((row) => typeof row[column] === "number") ? "number" : "");
    const button = element("button", name);
    button.type = "button";
    button.addEventListener("click", () => sort_by(table, column));
    head.append(button);
    return head;
  })));
  study.rows.forEach((cells, n) => {
    const row = row_of(cells.map((cell) => (typeof cell === "number" ? element("td", number(cell), "number")
      : element("td", cell === "" ? "–" : cell, "name"))));
    row.dataset.row = n;
    table.tBodies[0].append(row);
  });
}

function sort_by(table, column) {
  state.down = state.sorted === column && !state.down;
  state.sorted = column;
  for (const head of table.tHead.rows[0].cells) head.removeAttribute("aria-sort");
  table.tHead.rows[0].cells[column].setAttribute("aria-sort", state.down ? "descending" : "ascending");
  const order = [...table.tBodies[0].rows].sort((a, b) => {
    const n = Number(a.dataset.row), m = Number(b.dataset.row);
    const d = compare_values(study.rows[n][column], study.rows[m][column]);
    return d === 0 || Number.isNaN(d) ? n - m : Number.isFinite(d) && state.down ? -d : d;
  });
  table.tBodies[0].replaceChildren(...order);
}

function filter_machines() {
  const words = document.getElementById("filter").value.toLowerCase().split(/\s+/);
  const rows = [...document.getElementById("points").tBodies[0].rows];
  for (const row of rows) {
    const text = study.rows[Number(row.dataset.row)].join(" ").toLowerCase();
    row.hidden = !words.every((word) => text.includes(word));
  }
  document.getElementById("shown").textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`;
}

function fill_peers() {
  const table = document.getElementById("peers");
  table.append(element("thead"), element("tbody"));
  table.tHead.append(row_of(["machine and scene", "known", "particles", "particle-steps/s", "J per particle-step", "source"].map((name) => element("th", name))));
  for (const peer of study.peers)
    table.tBodies[0].append(row_of([peer.what, peer.known, number(peer.particles), number(peer.rate, 3),
      peer.joules[0] === peer.joules[1] ? number(peer.joules[0], 3) : `${number(peer.joules[0], 3)} to ${number(peer.joules[1], 3)}`, peer.source]
      .map((text) => element("td", text))));
}

document.getElementById("summary").textContent = study.summary;
document.getElementById("constraints").append(...study.constraints.map((text) => element("li", text)));
draw_charts();
fill_machines();
filter_machines();
fill_peers();
document.getElementById("filter").addEventListener("input", filter_machines);

function fit(width) {
  for (const chart of charts) chart.resize(width ? {width} : {width: "auto"});
}
window.addEventListener("resize", () => fit());
window.addEventListener("beforeprint", () => fit(680));
window.addEventListener("afterprint", () => fit());
