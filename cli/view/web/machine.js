// SPDX-License-Identifier: MIT
// The machine of a run in the place of its particles: nodes coloured by what the run recorded of them, cycle by cycle of a step.
import {table_of} from "./colours.js";
import {Chart} from "./curves.js";
import {by_id} from "./format.js";
import {colour_of_phase, kBehind, kBefore, tell_node, timeline_of} from "./node_text.js";
import {Spans, kNodeWords} from "./spans.js";

const kCells = 3;              // word of a node
const kRate = 15, kPasses = 150;  // pictures a second, and of a whole step at most

const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

export class Machine {
  constructor(page, source) {
    this.page = page;
    this.source = source;
    this.told = page.story.machine;
    this.chosen = -1;
    this.step = -1;
    this.cycle = 0;
    this.wanted = 0;
  }
  // Whether what it shows has come.
  get ready() { return Boolean(this.held) && (this.told.steps === 0 || Boolean(this.spans)); }
  // The steps that the page has.
  get steps() { return this.told.kept ? this.told.kept.length : this.told.steps; }
  step_at(index) { return this.told.kept ? this.told.kept[index] : index; }
  // Of the last one that begins at or before a step: its place among them.
  place_of(step) {
    if (!this.told.kept) return Math.min(step, this.told.steps - 1);
    let k = this.told.kept.length - 1;
    while (k > 0 && this.told.kept[k] > step) --k;
    return k;
  }

  choices() {
    const {told} = this, found = [];
    const whole = (name, key, unit = "") => found.push({name, key, unit});
    if (told.steps > 0) {
      whole("phase in a cycle", "phase");
      whole("cycles of the step", "step", "cycles");
      whole("wait for late neighbours", "wait", "cycles");
      whole("start of the step", "start", "cycles");
      told.phases.forEach((name, p) => found.push({name: name.replaceAll("_", " "), key: p, unit: "cycles"}));
    }
    whole("particles held", "held");
    if (told.nodes > 0 && told.brick.some((cells) => cells > 1)) whole("cells", "cells");
    return found;
  }

  begin() {
    const {told} = this;
    if (told.nodes === 0 || told.steps === 0) {
      by_id("machine-why").textContent = told.missing || "The run recorded no cycles. This records them:";
      by_id("machine-command").textContent = told.command;
    }
    if (told.nodes === 0) return;
    this.colours = this.choices();
    this.colours.forEach(({name}, k) => by_id("machine-colour").append(new Option(name, String(k))));
    by_id("at-step").max = String(Math.max(0, this.steps - 1));
    const on = (id, event, work) => by_id(id).addEventListener(event, () => this.page.attempt(work));
    on("machine-colour", "change", () => this.colour());
    on("at-step", "input", () => this.take(Number(by_id("at-step").value)));
    on("at-cycle", "input", () => { this.cycle = Number(by_id("at-cycle").value); return this.colour(); });
    on("play-cycles", "click", () => this.play());
    if (told.per_step) {
      const {head} = this.page.story;
      this.chart = new Chart(told.per_step, head.static ? 1 : head.dt, head.static ? "steps" : head.reduced ? "" : "s", true);
      by_id("cycles-chart").append(this.chart.figure);
    }
  }

  // With a frame of the run: the particles held there, and the step that begins with it.
  async show(frame) {
    const {page, told, source} = this;
    if (told.nodes === 0) return;
    if (!this.nodes) {
      this.nodes = new Int32Array(await source.machine("nodes", 0));
      page.stage.build(this.nodes, told);
    }
    this.held = new Uint32Array(await source.machine("held", frame));
    this.held_step = page.story.frames[frame].step;
    if (told.steps > 0) await this.take(this.place_of(this.held_step));
    else this.colour();
  }
  // Of two that are asked for one after the other the last stays.
  async take(place) {
    const step = this.step_at(place), asked = ++this.wanted;
    if (step !== this.step) {
      const words = new Uint32Array(await this.source.machine("spans", step));
      if (asked !== this.wanted) return;
      // The same share of the step is looked at.
      const share = this.spans ? this.cycle / Math.max(1, this.spans.length - 1) : 0.5;
      this.spans = new Spans(words, this.nodes, this.told);
      this.step = step;
      this.cycle = Math.round(share * (this.spans.length - 1));
      by_id("at-step").value = String(place);
      by_id("at-cycle").max = String(this.spans.length - 1);
      this.chart?.at(step);
    }
    this.colour();
  }

  choice() { return this.colours[Number(by_id("machine-colour").value)]; }
  values_of({key}) {
    const {spans} = this, of = {
      held: (n) => this.held[n], cells: (n) => this.nodes[n * kNodeWords + kCells],
      step: (n) => spans.end_of(n) - spans.begin_of(n), wait: (n) => spans.wait_of(n), start: (n) => spans.begin_of(n),
    }[key] || ((n) => spans.cycles(n, key));
    return Float32Array.from({length: this.told.nodes}, (_, n) => of(n));
  }
  colour() {
    const {page, spans} = this, choice = this.choice(), nodes = page.stage.nodes;
    if (spans) {
      by_id("at-cycle").value = String(this.cycle);
      by_id("step-now").textContent = `step ${this.step}`;
      by_id("cycle-now").textContent = `cycle ${this.cycle} of ${spans.length}, of the run ${spans.base + this.cycle}`;
    }
    by_id("cycle-part").hidden = choice.key !== "phase";
    if (choice.key === "phase") this.colour_phases();
    else {
      const values = this.values_of(choice);
      let low = Infinity, high = -Infinity;
      for (const value of values) low = Math.min(low, value), high = Math.max(high, value);
      nodes.colour(values, null, low, high > low ? high : low + 1, table_of("viridis"), true);
      nodes.arrows([]);
      page.tell_scale(choice.name, "viridis", String(low), high + (choice.unit ? " " + choice.unit : ""));
    }
    this.tell();
    page.stage.draw();
  }
  colour_phases() {
    const {told, spans, cycle} = this, {nodes} = this.page.stage, count = told.phases.length, all = count + 2;
    const values = new Float32Array(told.nodes), waits = new Float32Array(told.nodes), arrows = [], held = new Array(all).fill(0);
    for (let n = 0; n < told.nodes; ++n) {
      const phase = spans.phase_at(n, cycle), entry = phase < 0 ? count + 1 : phase;  // count: behind the step
      values[n] = entry + 0.5;
      ++held[entry];
      if (phase < 0 || phase >= count) continue;
      for (const {face, until} of spans.late(n, phase)) if (cycle < until) waits[n] = 1, arrows.push({node: n, face});
    }
    const table = new Uint8Array(4 * 256);
    const colours = Array.from({length: all}, (_, k) => (k < count ? colour_of_phase(told, k) : k === count ? kBehind : kBefore));
    for (let k = 0; k < 256; ++k) table.set([...channels(colours[Math.min(all - 1, Math.floor((k * all) / 256))]), 255], 4 * k);
    nodes.colour(values, waits, 0, all, table, false);
    nodes.arrows(arrows);
    this.counts = held;
    this.waiting = waits.reduce((sum, one) => sum + one, 0);
    const names = [...told.phases.map((name) => name.replaceAll("_", " ")), "past this step", "before this step"];
    const entries = names.map((name, k) => ({name: `${name}: ${held[k]}`, colour: colours[k], k}))
      .filter(({k}) => held[k] > 0 || (k < count && this.occurs(k)));
    entries.push({name: `dark, with arrows to whom they wait for: ${this.waiting}`, colour: "#333333"});
    this.page.tell_list(entries);
  }
  // Whether any node is in a phase for a cycle: flat plans lack two.
  occurs(phase) {
    for (let n = 0; n < this.told.nodes; ++n) if (this.spans.cycles(n, phase) > 0) return true;
    return false;
  }

  choose(node) {
    this.chosen = node;
    this.page.stage.nodes.choose(node);
    this.tell();
    this.page.stage.draw();
  }
  tell() {
    by_id("node-part").hidden = this.chosen < 0;
    by_id("node-none").hidden = this.chosen >= 0;
    if (this.chosen < 0) return;
    tell_node(this, by_id("node"));
    by_id("timeline").replaceChildren(...(this.spans ? [timeline_of(this)] : []));
  }

  // Whether the picture is of a cycle.
  plays_cycles() { return this.page.nodes_shown() && Boolean(this.spans) && this.choice().key === "phase"; }
  // From the one that is shown, or from the first where that is the last: cycle by cycle, or so many at a time that a step takes
  // ten seconds.
  *cycles_to_play() {
    const last = this.spans.length - 1, by = Math.max(1, Math.ceil(this.spans.length / kPasses));
    let cycle = this.cycle < last ? this.cycle : 0;
    for (; cycle < last; cycle = Math.min(last, this.cycle + by)) yield cycle;
    yield last;
  }
  show_cycle(cycle) {
    this.cycle = cycle;
    this.colour();
  }
  play() {
    this.playing = !this.playing;
    by_id("play-cycles").textContent = this.playing ? "stop" : "play cycles";
    if (!this.playing) return;
    const cycles = this.cycles_to_play(), next = () => {
      if (!this.playing) return;
      const {value, done} = cycles.next();
      if (done) return this.play();
      this.show_cycle(value);
      setTimeout(next, 1000 / kRate);
    };
    next();
  }
}
