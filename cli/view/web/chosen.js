// SPDX-License-Identifier: MIT
// The particle that was picked: its numbers in SI, and its words bit by bit.
import {array_of} from "./blocks.js";
import {element, number, with_unit} from "./format.js";
import {exact_of} from "./words.js";

const kAxes = ["x", "y", "z"];

function row(table, name, texts, unit) {
  const line = element("tr");
  line.append(element("th", name));
  const cell = element("td");
  for (const text of texts) cell.append(element("span", text, "value"), " ");
  if (unit && unit !== "1") cell.append(unit);
  line.append(cell);
  table.append(line);
}

// `place`: where it stands in the blocks; `id`: in the run; `still`: whether it is still wanted once its numbers are here.
export async function tell_particle(source, story, frame, place, id, table, still) {
  const {head} = story, types = await source.row(frame, head.type, place);
  const exact = exact_of(head, await source.row(frame, head.exact, place));
  const fields = await Promise.all(head.blocks.map((form, k) => (form.field ? source.row(frame, k, place) : null)));
  if (!still()) return null;
  table.replaceChildren();
  const type = head.types[new Uint8Array(types)[0]];
  row(table, "particle", [String(id)]);
  row(table, "type", [type ? type.material + (type.constraint ? ", " + type.constraint : "") : "–"]);
  if (type) row(table, "mass", [number(type.mass, 6)], head.reduced ? "" : "kg");
  row(table, "position", exact.x.map((x) => number(x, 10)), head.reduced ? "" : "m");
  row(table, "velocity", exact.v.map((v) => number(v, 10)), head.reduced ? "" : "m/s");
  head.blocks.forEach((form, k) => {
    if (!form.field || form.name === "velocity") return;
    const values = [...array_of(form, fields[k])];
    if (values.every(Number.isNaN)) return;
    row(table, form.name.replaceAll("_", " "), values.map((value, c) => (form.components.length ? form.components[c] + " " : "") + number(value, 6)), form.unit);
  });
  if (!exact.cell) return exact;
  row(table, "cell", exact.cell.map(String));
  for (const [name, key] of [["position", "x"], ["velocity", "v"]])
    kAxes.forEach((axis, k) => {
      const line = element("tr", undefined, "word");
      line.append(element("th", `${name} ${axis}`));
      const cell = element("td");
      cell.append(element("code", exact.bits[key][k]), element("span", ` ${exact.words[key][k]}`, "note"));
      line.append(cell);
      table.append(line);
    });
  const told = element("tr");
  told.append(element("th", ""), element("td", `Words: offset in the cell in 2^-${head.words.fraction} of its edge; velocity in the same per step of ${with_unit(head.dt, "s")}.`, "note"));
  table.append(told);
  return exact;
}
