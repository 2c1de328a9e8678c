// SPDX-License-Identifier: MIT
// The node that was picked: its numbers, and its phases beside those of its neighbours.
import {kTypes} from "./colours.js";
import {element} from "./format.js";
import {kNeighbours, kNodeWords} from "./spans.js";

export const kBehind = "#b9bfc4", kBefore = "#e6e9eb";

// A kind of phase has its colour in all rounds.
export const colour_of_phase = (machine, phase) => kTypes[machine.kinds[phase] % kTypes.length];

const kFaces = ["-x", "+x", "-y", "+y", "-z", "+z"];

function line_of(name, ...texts) {
  const line = element("tr");
  line.append(element(name, texts[0]), ...texts.slice(1).map((text) => element("td", text)));
  return line;
}

const cell_of = ({nodes}, n) => [...nodes.subarray(n * kNodeWords, n * kNodeWords + 3)].join(" ");

// Who holds a node up in a phase, in words.
function awaited(machine, node, phase) {
  const {spans} = machine;
  return spans.late(node, phase).map(({node: other, face, until}) => `${kFaces[face]} (node ${other}) until ${spans.base + until}`).join(", ");
}

export function tell_node(machine, table) {
  const {chosen: n, nodes, told, spans} = machine, cells = nodes[n * kNodeWords + 3], cut = nodes[n * kNodeWords + 4];
  const rows = [line_of("th", "node", String(n)), line_of("th", cells > 1 ? "lowest cell" : "cell", cell_of(machine, n))];
  if (told.brick.some((edge) => edge > 1)) rows.push(line_of("th", "cells", String(cells)));
  if (cut) rows.push(line_of("th", "to other devices", kFaces.filter((_, face) => (cut >> face) & 1).join(" ")));
  rows.push(line_of("th", "particles", `${machine.held[n]} at step ${machine.held_step}`));
  if (spans) {
    rows.push(line_of("th", `step ${machine.step}`, `${spans.end_of(n) - spans.begin_of(n)} cycles`));
    rows.push(line_of("th", "of them waits", `${spans.wait_of(n)} cycles`));
    const parts = element("table", undefined, "phases");
    parts.append(line_of("th", "phase"));
    parts.rows[0].append(...["first", "last", "cycles", "waits"].map((name) => element("th", name)));
    told.phases.forEach((name, p) => {
      if (spans.cycles(n, p) === 0) return;
      const numbers = [spans.base + spans.start(n, p), spans.base + spans.end(n, p) - 1, spans.cycles(n, p), told.axes[p] < 0 ? "" : spans.wait(n, p)];
      const line = line_of("th", name.replaceAll("_", " "), ...numbers.map(String));
      const dot = element("span", "", "dot");
      dot.style.background = colour_of_phase(told, p);
      line.cells[0].prepend(dot);
      const whom = awaited(machine, n, p);
      if (whom) line.title = `waits for ${whom}`;
      parts.append(line);
    });
    const holder = element("tr"), cell = element("td");
    cell.colSpan = 2;
    cell.append(parts);
    holder.append(cell);
    rows.push(holder);
  }
  table.replaceChildren(...rows);
}

const kWide = 340, kRow = 20, kName = 62, kLight = 3;

// A bar for each phase of the node and of its neighbours, over the cycles of the step; what is dark waits. Marks the cycle that is
// looked at.
export function timeline_of(machine) {
  const {chosen, nodes, told, spans} = machine;
  const svg = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const rows = [{name: "this node", node: chosen}];
  kFaces.forEach((face, k) => {
    const other = nodes[chosen * kNodeWords + kNeighbours + k];
    if (other >= 0 && other !== chosen) rows.push({name: face, node: other});
  });
  const high = rows.length * kRow + 4, x = (cycle) => kName + (cycle / spans.length) * (kWide - kName - 2);
  const picture = svg("svg", {viewBox: `0 0 ${kWide} ${high}`, role: "img", "aria-label": "phases of the node and its neighbours"});
  rows.forEach(({name, node}, k) => {
    const y = 2 + k * kRow, bar = (from, to, top, height, fill, title) => {
      const made = svg("rect", {x: x(from).toFixed(2), y: top, width: Math.max(0.4, x(to) - x(from)).toFixed(2), height, fill});
      made.append(svg("title", {}, title));
      picture.append(made);
    };
    picture.append(svg("text", {x: kName - 5, y: y + kRow / 2 + 3, "text-anchor": "end"}, name));
    told.phases.forEach((phase, p) => {
      if (spans.cycles(node, p) === 0) return;
      // The force engine may run beside an exchange: it has the lower part of the row.
      const start = spans.start(node, p), end = spans.end(node, p), beside = told.axes[p] < 0 && start < (p > 0 ? spans.end(node, p - 1) : 0);
      const [top, height] = beside ? [y + kRow - 6, 4] : [y + kLight, kRow - 2 * kLight - 2];
      const title = `node ${node}, ${phase.replaceAll("_", " ")}: cycles ${spans.base + start} to ${spans.base + end - 1}`;
      bar(start, end, top, height, colour_of_phase(told, p), title);
      const wait = told.axes[p] < 0 ? 0 : spans.wait(node, p);
      if (wait > 0) bar(start, start + wait, top, height, "rgba(0, 0, 0, 0.55)", `waits ${wait} cycles for ${awaited(machine, node, p)}`);
    });
  });
  const at = x(machine.cycle + 0.5);
  picture.append(svg("line", {x1: at, x2: at, y1: 0, y2: high, class: "mark"}));
  return picture;
}
