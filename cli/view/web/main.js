// SPDX-License-Identifier: MIT
// Puts the page together: frames, colours, time line, cut, picking, and the run while it goes.
import {Beside} from "./beside.js";
import {SavedFrames, ServedFrames, array_of} from "./blocks.js";
import {tell_particle} from "./chosen.js";
import {gradient_of, kTypes, range_of, table_of, table_of_types} from "./colours.js";
import {charts_of, grow} from "./curves.js";
import {Film} from "./film.js";
import {by_id, element, number, save, with_unit} from "./format.js";
import {follow} from "./live.js";
import {Machine} from "./machine.js";
import {Stage} from "./stage.js";
import {Steer, settle} from "./steer.js";

const embedded = JSON.parse(by_id("story").textContent);
const source = embedded.served ? new ServedFrames(embedded) : new SavedFrames(embedded);

class Page {
  constructor(story) {
    this.story = story;
    this.frame = -1;
    this.chosen = -1;
    this.held = null;
    this.charts = [];
    if (story.machine) this.machine = new Machine(this, source);
    if (story.with) this.beside = new Beside(this, embedded.served ? new ServedFrames(story.with.story, "with/") : new SavedFrames(story.with.story, "w-"));
  }

  // What colours can be of: each field, of a vector its length and its parts.
  choices(head) {
    const {blocks, types} = head, found = [];
    blocks.forEach((form, block) => {
      if (!form.field) return;
      const name = form.name.replaceAll("_", " ");
      if (form.components.length === 3) found.push({name: form.name === "velocity" ? "speed" : name, block, part: -1, unit: form.unit});
      if (!form.components.length) found.push({name, block, part: 0, unit: form.unit});
      form.components.forEach((part, k) => found.push({name: `${name} ${part}`, block, part: k, unit: form.unit}));
    });
    if (types.length > 1) found.push({name: "type", block: head.type, part: -2, unit: ""});
    return found;
  }

  begin() {
    const {head} = this.story;
    by_id("title").textContent = head.title;
    document.title = head.title;
    by_id("lead").textContent = this.lead();
    this.colours = this.choices(head);
    this.colours.forEach(({name}, k) => by_id("colour").append(new Option(name, String(k))));
    const first = this.colours.findIndex(({name}) => name === head.colour);
    by_id("colour").value = String(Math.max(0, first));
    for (const axis of ["", "x", "y", "z"]) by_id("cut-axis").append(new Option(axis || "no cut", axis));
    this.tell_lists();
    settle(this.story.frames, head.dt);
    if (this.story.live) grow(this.story.curves, this.story.frames);
    if (this.story.steered) this.steer = new Steer(this, source), this.steer.begin(this.story.steered);
    this.tell_curves();
    by_id("what-part").hidden = !this.machine;
    this.machine?.begin();
    this.beside?.begin();
    this.film = new Film(this);
    this.listen();
  }
  lead() {
    const {head, frames, left_out} = this.story;
    const shown = head.shown < head.particles ? `, of which ${head.shown} are shown` : "";
    return `${head.particles} particles${shown}, ${head.engine} engine, ${frames.length} frames${left_out ? ` (${left_out})` : ""}`;
  }
  tell_lists() {
    const {warnings, facts, lines} = this.story;
    by_id("warnings").replaceChildren(...warnings.map((text) => element("li", text)));
    by_id("warnings-part").hidden = warnings.length === 0;
    by_id("facts").replaceChildren(...facts.flatMap(([name, text]) => [element("dt", name), element("dd", text)]));
    by_id("facts-part").hidden = facts.length === 0;
    by_id("log").textContent = lines.join("\n");
    by_id("log-part").hidden = lines.length === 0;
  }

  // Of a run that goes, once more where they have grown.
  tell_curves() {
    const read = this.story.curves.filter((curve) => curve.step.length > 0);
    if (this.charts.length === read.length) this.charts.forEach((chart) => chart.draw());
    else this.charts = charts_of(this.story, by_id("curves"));
    by_id("curves-none").hidden = this.charts.length > 0;
    if (this.frame >= 0) this.tell_readings();
  }
  tell_readings() {
    for (const chart of this.charts) chart.at(this.story.frames[this.frame].step);
  }

  listen() {
    const on = (id, event, work) => by_id(id).addEventListener(event, () => this.attempt(work));
    on("time", "input", () => this.show(Number(by_id("time").value)));
    on("back", "click", () => this.show(Math.max(0, this.frame - 1)));
    on("next", "click", () => this.show(Math.min(this.story.frames.length - 1, this.frame + 1)));
    on("play", "click", () => this.play());
    on("colour", "change", () => { this.held = null; by_id("hold").checked = false; return this.recolour(); });
    on("hold", "change", () => { this.held = by_id("hold").checked ? this.range : null; return this.recolour(); });
    on("what", "change", () => this.swap());
    for (const id of ["cut-axis", "cut-at", "cut-turn"]) on(id, "input", () => this.cut());
    document.querySelectorAll("#looks [data-look]").forEach((button) =>
      button.addEventListener("click", () => this.stages().forEach((stage) => stage.look(button.dataset.look))));
    on("picture", "click", async () => save(await this.stage.picture(), `frame_${this.story.frames[this.frame].step}.png`));
    this.picks(by_id("canvas"), (x, y) => (this.nodes_shown() ? this.machine.choose(this.stage.pick_node(x, y)) : this.choose(this.stage.pick(x, y))));
    document.addEventListener("keydown", (event) => {
      if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
      const key = {ArrowLeft: "back", ArrowRight: "next", " ": "play"}[event.key];
      if (key) event.preventDefault(), by_id(key).click();
    });
  }
  stages() { return [this.stage, this.beside?.stage].filter(Boolean); }
  // A click on a picture that does not turn it.
  picks(canvas, pick) {
    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      this.attempt(() => pick(event.clientX - box.left, event.clientY - box.top));
    });
  }
  async attempt(work) {
    try {
      await work();
    } catch (error) {
      by_id("problem").textContent = String(error.message || error);
      by_id("problem").hidden = false;
    }
  }

  // Shows a frame. Of those asked for while another is being fetched, the last is shown alone.
  async show(frame) {
    this.wanted = frame;
    if (this.busy) return this.busy;
    this.busy = (async () => {
      while (this.wanted !== this.frame && this.wanted >= 0) await this.fetch_frame(this.wanted);
    })().finally(() => { this.busy = null; });
    return this.busy;
  }
  async fetch_frame(frame) {
    const {head, frames} = this.story, {step, time, lower, extent} = frames[frame];
    const places = array_of(head.blocks[0], await source.block(frame, 0));
    const others = this.beside && array_of(head.blocks[0], await this.beside.source.block(frame, 0));
    const first = !this.stage;
    if (first) this.stage = new Stage(by_id("canvas"), head, {step, lower, extent}, by_id("axes"));
    this.stage.show(places, {step, lower, extent});
    this.beside?.show(others, frame, {step, lower, extent});
    if (first) this.cut();
    this.frame = frame;
    await this.recolour();
    await this.tell_chosen();
    if (this.machine_shown()) await this.machine.show(frame);
    by_id("time").max = String(frames.length - 1);
    by_id("time").value = String(frame);
    by_id("now").textContent = `frame ${frame + 1} of ${frames.length}, step ${step}${head.static ? "" : ", " + with_unit(time, head.reduced ? "" : "s", 5)}` +
      (this.beside ? `: ${this.beside.told(frame)}` : "");
    this.tell_readings();
    ++this.shown_count;
    this.draw();
  }
  draw() { this.stages().forEach((stage) => stage.draw()); }
  shown_count = 0;

  // The machine, or particles. Where a run has no machine its particles stay, and a line says why.
  machine_shown() { return Boolean(this.machine) && by_id("what").value === "machine"; }
  nodes_shown() { return this.machine_shown() && this.machine.ready; }
  async swap() {
    const machine = this.machine_shown(), {told} = this.machine, nodes = machine && told.nodes > 0;
    document.querySelectorAll(".of-machine").forEach((part) => { part.hidden = !nodes; });
    document.querySelectorAll(".of-particles").forEach((part) => { part.hidden = nodes; });
    by_id("steps-row").hidden = !nodes || told.steps === 0;
    by_id("machine-missing").hidden = !machine || told.steps > 0;
    if (!this.stage) return;
    if (nodes) await this.machine.show(this.frame);
    this.stage.swap(nodes);
    this.cut();
    if (!nodes) await this.recolour();
  }

  async recolour() {
    if (this.nodes_shown()) return;
    const choice = this.colours[Number(by_id("colour").value)], values = [await this.values_of(source, this.story.head, choice)];
    if (this.beside) {
      const {head} = this.beside.story, same = this.choices(head).find(({name}) => name === choice.name);
      values.push(same ? await this.values_of(this.beside.source, head, same) : new Float32Array(values[0].length).fill(NaN));
    }
    if (choice.part === -2) return this.colour_types(values);
    // One range for both, so that equal colours are equal values.
    const all = values.length === 1 ? values[0] : Float32Array.from({length: 2 * values[0].length}, (_, k) => values[k % 2][k >> 1]);
    this.range = this.held || range_of(all);
    const kind = this.range.signed ? "diverging" : "viridis";
    this.stages().forEach(({cloud}, k) => {
      cloud.table(table_of(kind), true);
      cloud.colour(values[k], this.range.low, this.range.high);
    });
    this.tell_scale(choice.name + (this.range.empty ? ": not known" : ""), kind, number(this.range.low), with_unit(this.range.high, choice.unit));
    this.draw();
  }
  // A number for each particle of the frame.
  async values_of(source, head, {block, part}) {
    const form = head.blocks[block], all = array_of(form, await source.block(this.frame, block));
    if (part === -2) return Float32Array.from(all, (type) => type + 0.5);
    const values = new Float32Array(all.length / form.numbers);
    for (let k = 0; k < values.length; ++k)
      values[k] = part >= 0 ? all[k * form.numbers + part] : Math.hypot(all[3 * k], all[3 * k + 1], all[3 * k + 2]);
    return values;
  }
  // What colours say: a scale between two numbers, or names.
  tell_scale(name, kind, low, high) {
    by_id("legend-bar").style.background = gradient_of(kind);
    by_id("legend").hidden = false;
    by_id("types").hidden = true;
    by_id("legend-low").textContent = low;
    by_id("legend-high").textContent = high;
    by_id("legend-name").textContent = name;
  }
  tell_list(entries) {
    by_id("legend").hidden = true;
    by_id("types").hidden = false;
    by_id("types").replaceChildren(...entries.map(({name, colour}) => {
      const entry = element("li", name), dot = element("span", "", "dot");
      dot.style.background = colour;
      entry.prepend(dot);
      return entry;
    }));
  }
  colour_types(values) {
    const {types} = this.story.head;
    this.range = {low: 0, high: types.length, signed: false};
    this.stages().forEach(({cloud}, k) => {
      cloud.table(table_of_types(types.length), false);
      cloud.colour(values[k], 0, types.length);
    });
    this.tell_list(types.map(({material, constraint}, k) => ({name: material + (constraint ? ", " + constraint : ""), colour: kTypes[k % kTypes.length]})));
    this.draw();
  }
  cut() {
    const axis = by_id("cut-axis").value;
    by_id("cut-at").disabled = by_id("cut-turn").disabled = !axis;
    this.stages().forEach((stage) => stage.cut(axis, Number(by_id("cut-at").value), by_id("cut-turn").checked));
    this.draw();
  }

  async choose(place) {
    this.chosen = place;
    this.stages().forEach((stage) => stage.choose(place));
    await this.tell_chosen();
  }
  async tell_chosen() {
    by_id("chosen-part").hidden = this.chosen < 0;
    by_id("chosen-none").hidden = this.chosen >= 0;
    if (this.chosen < 0) return this.beside?.tell(this.frame, -1);
    const {frame, chosen} = this, still = () => frame === this.frame && chosen === this.chosen;
    this.exact = (await tell_particle(source, this.story, frame, chosen, this.id_of(chosen), by_id("chosen"), still)) || this.exact;
    await this.beside?.tell(frame, chosen, this.id_of(chosen), still);
  }
  // Where a part is shown, it is every so-manieth particle.
  id_of(place) {
    const {particles, shown} = this.story.head;
    return Math.floor((place * particles) / shown);
  }

  play() {
    this.playing = !this.playing;
    by_id("play").textContent = this.playing ? "stop" : "play";
    const next = async () => {
      if (!this.playing) return;
      const last = this.story.frames.length - 1;
      if (this.frame >= last && !this.story.live) {
        this.playing = false;
        by_id("play").textContent = "play";
        return;
      }
      const began = performance.now();
      if (this.frame < last) await this.show(this.frame + 1);
      setTimeout(() => this.attempt(next), Math.max(0, 1000 / 15 - (performance.now() - began)));
    };
    if (this.playing && this.frame >= this.story.frames.length - 1 && !this.story.live) this.attempt(async () => { await this.show(0); await next(); });
    else if (this.playing) this.attempt(next);
  }
}

async function start() {
  let story = embedded;
  while (embedded.served && !story.head) {
    story = await (await source.ask("story")).json();
    if (story.head) break;
    by_id("ready").textContent = "the run has no frame yet";
    await new Promise((done) => setTimeout(done, 300));
  }
  source.story = story;
  source.live = story.live;
  const page = new Page(story);
  globalThis.cuboct = {page, source, story};
  await page.attempt(async () => {
    page.begin();
    if (story.live) follow(page, source);
    if (story.with?.difference.first) await page.beside.show_first();
    else if (story.frames.length > 0) await page.show(story.live ? story.frames.length - 1 : 0);
    else by_id("now").textContent = story.live ? "no frame yet" : "the run kept no frames";
    by_id("ready").hidden = true;
  });
}
start().catch((error) => { by_id("ready").textContent = String(error.message || error); });
