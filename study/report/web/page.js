// SPDX-License-Identifier: MIT
// Puts the page together: selectors, charts, tables.
"use strict";

// What the reader chose: the measures' indices, the table's order and its marked point.
const state = {error: 0, speed: 0, sorted: "", down: false, chosen: -1};

function draw() {
  draw_charts();
  fill_decades();
  fill_points();
}

function fill_select(id, measures, key) {
  const select = document.getElementById(id);
  measures.forEach((measure, k) => select.append(new Option(measure.label, String(k))));
  select.value = String(state[key]);
  select.addEventListener("change", () => {
    state[key] = Number(select.value);
    draw();
  });
}

const times = (count) => (count === 1 ? "once" : `${count} times`);

// Where the cutoff is lengthened, those rungs follow the ones of the time step.
function truth_text(truth) {
  const rungs = truth.rungs, lengthened = rungs.filter((rung) => rung.cutoff !== rungs[0].cutoff).length;
  return (rungs.length
    ? `Errors are measured against a run in doubles, its time step halved ${times(rungs.length - 1 - lengthened)}` +
      (lengthened ? `, then its cutoff lengthened ${times(lengthened)}. ` : ". ") +
      (truth.converged ? "Its figures changed by less than the study's tolerance at the last rung. "
                       : "It has not converged to the study's tolerance. ")
    : "") +
    (truth.floor !== null && truth.floor > 0 ? `Its own trajectory is uncertain by ${number(truth.floor, 2)} pitches at the horizon. ` : "") +
    (truth.lyapunov_time !== null && truth.lyapunov_time > 0 ? `Neighbouring runs part by a factor of e in ${number(truth.lyapunov_time, 3)} s. ` : "") +
    (truth.largest_frequency ? `The fastest vibration takes ${number(2 * Math.PI / truth.largest_frequency, 3)} s.` : "");
}

function summarise() {
  const count = (status) => study.points.filter((p) => p.status === status).length;
  // Those of the points that were measured elsewhere.
  const others = [...new Set(study.points.map((p) => p.machine))].filter((machine) => machine);
  document.getElementById("summary").textContent =
    `${study.points.length} points: ${count("done")} done, ${count("unstable")} unstable, ${count("refused")} refused. Machine: ${study.machine || "not told"}` +
    (others.length ? `; of some points ${others.join(", ")}.` : ".");
  document.getElementById("truth-text").textContent = truth_text(study.truth);
  document.getElementById("truth-notes").append(...study.truth.notes.map((note) => element("li", note)));
  const about = document.getElementById("about");
  for (const [name, text] of [["Machine", study.machine], ...others.map((machine) => ["Machine", machine]), ["Scene", study.scene]]) {
    const value = element("dd");
    value.append(element(text.includes("\n") ? "pre" : "span", text || "not told"));
    about.append(element("dt", name), value);
  }
}

// What the scene is run for comes first: the worst figure, or the only one; without figures the trajectory.
const first_error = study.errors.findIndex((e) => e.id.startsWith("figure"));
state.error = Math.max(0, first_error >= 0 ? first_error : study.errors.findIndex((e) => e.id === "trajectory"));
fill_select("error", study.errors, "error");
fill_select("speed", study.speeds, "speed");
summarise();
draw_series_names();
draw();
fill_rungs();
for (const [id, event] of [["filter", "input"], ["status", "change"]])
  document.getElementById(id).addEventListener(event, () => { draw_charts(); filter_points(); });

function fit(width) {
  for (const chart of charts) chart.resize(width ? {width} : {width: "auto"});
}
let was_narrow = narrow();
window.addEventListener("resize", () => {
  fit();
  if (narrow() !== was_narrow) {
    was_narrow = narrow();
    draw_charts();
  }
});
window.addEventListener("beforeprint", () => fit(680));
window.addEventListener("afterprint", () => fit());
