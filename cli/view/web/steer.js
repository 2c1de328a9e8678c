// SPDX-License-Identifier: MIT
// What a page changes of its run: imposed velocities, and particles that the mouse pulls. Parts of the run count their steps from
// their own start; the page counts those of all.
import {by_id, element} from "./format.js";
import {Hand} from "./hand.js";

// Frames as they came, with the steps of the whole run.
export function settle(frames, dt) {
  for (const frame of frames) {
    if (!frame.first) continue;
    frame.step += frame.first, frame.time += frame.first * dt;
    for (const curve of frame.read || []) curve.step = curve.step.map((step) => step + frame.first);
    frame.first = 0;
  }
}

export class Steer {
  constructor(page, source) {
    this.page = page;
    this.source = source;
  }
  begin(steered) {
    by_id("steer-part").hidden = false;
    const reduced = this.page.story.head.reduced, unit = (text) => (reduced ? "" : " " + text);
    this.rows = steered.led.map(({name, velocity}, k) => this.row(name, `velocity of ${name}`, velocity, unit("m/s"), ["velocity", k]));
    this.rows.push(this.row("gravity", "gravity", steered.gravity, unit("m/s²"), ["gravity"]));
    this.rows.push(this.row("damping", "damping", [steered.damping], unit("kg/s"), ["damping"]));
    by_id("pull-radius").value = steered.radius.toPrecision(3);
    by_id("pull-unit").textContent = reduced ? "" : "m";
    by_id("pull-steps").value = String(steered.for);
    this.hand = new Hand(this.page, (particle, way) => this.pull(particle, way));
    this.part = steered.part;
    this.tell(steered);
  }
  tell({part, first, steps, waits, over}) {
    if (this.told && part > this.part) {
      this.say(`${this.told} from step ${first} on.`);
      this.told = null;
      this.hand.let_go();
    }
    this.part = part;
    by_id("steer-now").textContent = over ? `The run ended at step ${first} of ${steps}, in ${part} part${part > 1 ? "s" : ""}.` :
      `Part ${part}, from step ${first} of ${steps}.${waits ? " The change is in force once the run goes on." : ""}`;
    for (const button of this.rows) button.disabled = over;
    if (over) this.hand.end();
    by_id("pull").disabled = over;
  }
  say(text, bad = false) {
    by_id("steer-told").textContent = text;
    by_id("steer-told").classList.toggle("bad", bad);
  }
  // `words`: what is asked for, less the numbers.
  row(name, told, values, unit, words) {
    const row = element("div", undefined, "row"), button = element("button", "change");
    const inputs = values.map((value, axis) => {
      const input = element("input");
      input.type = "number", input.step = "any", input.value = String(value);
      input.setAttribute("aria-label", told + (values.length > 1 ? ` along ${"xyz"[axis]}` : "") + unit);
      return input;
    });
    row.append(element("b", name), ...inputs, unit, button);
    button.addEventListener("click", () => this.page.attempt(() => this.change(name, inputs, words)));
    by_id("steer").append(row);
    return button;
  }
  async change(name, inputs, words) {
    const values = inputs.map(({valueAsNumber}) => valueAsNumber);
    if (values.some(Number.isNaN)) return this.say(values.length > 1 ? "Three numbers are needed." : "A number is needed.");
    await this.ask([...words, ...values], `${name}: ${values.length > 1 ? `[${values.join(", ")}]` : values[0]}`);
  }
  // `way`: m.
  async pull(particle, way) {
    const radius = by_id("pull-radius").valueAsNumber, steps = by_id("pull-steps").valueAsNumber;
    if (!(radius > 0) || !Number.isInteger(steps) || steps < 1) return this.say("A radius and a number of steps are needed.");
    const unit = this.page.story.head.reduced ? "" : " m", far = way.map((x) => Number(x.toPrecision(3)));
    await this.ask(["pull", particle, radius, ...way, steps], `particle ${particle} and what is near: by [${far.join(", ")}]${unit} in ${steps} steps,`);
  }
  async ask(words, told) {
    this.told = told;
    const wrong = await this.source.steer(words);
    if (wrong) this.told = null, this.hand.let_go();
    // The answer to a question of before may have come meanwhile.
    if (wrong || this.told) this.say(wrong || `${told} soon.`, Boolean(wrong));
  }
}
