// SPDX-License-Identifier: MIT
// Velocities that a run's page changes. Parts of the run count their steps from their own start; the page counts those of all.
import {by_id, element} from "./format.js";

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
  begin({led, part, parts, next}) {
    by_id("steer-part").hidden = false;
    const unit = this.page.story.head.reduced ? "" : " m/s";
    this.rows = led.map(({name, velocity}, k) => {
      const row = element("div", undefined, "row"), button = element("button", "change");
      const inputs = velocity.map((value, axis) => {
        const input = element("input");
        input.type = "number", input.step = "any", input.value = String(value);
        input.setAttribute("aria-label", `velocity of ${name} along ${"xyz"[axis]}${unit}`);
        return input;
      });
      row.append(element("b", name), ...inputs, unit, button);
      button.addEventListener("click", () => this.page.attempt(() => this.change(k)));
      by_id("steer").append(row);
      return {name, inputs, button};
    });
    this.tell({part, parts, next});
  }
  tell({part, parts, next}) {
    this.next = next;
    by_id("steer-now").textContent = next === null ? `Part ${part} of ${parts}, the last: nothing changes any more.` :
      `Part ${part} of ${parts}. A change is in force from step ${next} on.`;
    for (const {button} of this.rows) button.disabled = next === null;
  }
  async change(which) {
    const {name, inputs} = this.rows[which], values = inputs.map(({valueAsNumber}) => valueAsNumber);
    const told = by_id("steer-told");
    if (values.some(Number.isNaN)) return void (told.textContent = "Three numbers are needed.");
    const wrong = await this.source.steer(which, values), from = this.next;
    told.textContent = wrong || `${name}: [${values.join(", ")}] from step ${from} on.`;
    told.classList.toggle("bad", Boolean(wrong));
  }
}
