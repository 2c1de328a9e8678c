// SPDX-License-Identifier: MIT
// The second of two runs: its picture beside the first's, with one camera, and where the two first differ.
import {tell_particle} from "./chosen.js";
import {by_id, element} from "./format.js";
import {Stage} from "./stage.js";

const kRuns = ["A", "B"];

function line_of(...texts) {
  const line = element("tr");
  line.append(element("th", texts[0]), ...texts.slice(1).map((text) => element("td", text)));
  return line;
}

export class Beside {
  constructor(page, source) {
    const {story, difference, labels} = page.story.with;
    Object.assign(this, {page, source, story, difference, labels});
  }

  begin() {
    document.querySelector(".pictures").classList.add("two");
    by_id("picture-beside").hidden = false;
    this.caption(by_id("caption"), 0, this.page.story.head), this.caption(by_id("caption-beside"), 1, this.story.head);
    by_id("difference-part").hidden = false;
    const {first, besides, how, hashes} = this.difference, frames = this.page.story.frames.length;
    const compared = `${frames} frames of ${this.page.story.head.particles} particles${hashes > 0 ? `, ${hashes} state hashes` : ""}: ${how}.`;
    by_id("difference-none").textContent = (first || besides ? "Compared: " : "The runs are equal. Compared: ") + compared;
    by_id("difference-besides").hidden = !besides;
    by_id("difference-besides").textContent = (first ? "Recorded besides: " : "All frames are equal. Recorded besides: ") + besides;
    by_id("difference-found").hidden = !first;
    if (!first) return;
    const place = this.place_of(first.particle);
    by_id("difference-where").textContent = `step ${first.step}, particle ${first.particle}, ${first.field}` + (place < 0 ? " (not among those shown)" : "");
    const rows = kRuns.flatMap((run, k) => [["value", first.si[k] && first.si[k] + (first.unit === "1" ? "" : " " + first.unit)], ["bits", first.bits[k]],
      ["words", first.words[k]]].filter(([, text]) => text).map(([name, text]) => line_of(`${run}, ${name}`, text)));
    by_id("difference").replaceChildren(...rows);
    by_id("difference-show").addEventListener("click", () => this.page.attempt(() => this.show_first()));
  }
  caption(place, run, head) {
    place.hidden = false;
    place.replaceChildren(element("b", kRuns[run]), ` ${this.labels[run]}, ${head.engine} engine`);
  }
  // Where a particle stands in the blocks; -1: it is not shown.
  place_of(id) {
    const {particles, shown} = this.page.story.head;
    const place = Math.ceil((id * shown) / particles);
    return place < shown && Math.floor((place * particles) / shown) === id ? place : -1;
  }
  async show_first() {
    const {first} = this.difference;
    await this.page.show(first.frame);
    await this.page.choose(this.place_of(first.particle));
  }

  // Its picture of a frame: in the first's place and size, so that one camera is that of both.
  show(places, frame, first_box) {
    if (!this.stage) {
      this.stage = new Stage(by_id("canvas-beside"), this.story.head, first_box, by_id("axes-beside"));
      this.page.stage.lead(this.stage), this.stage.lead(this.page.stage);
      const canvas = this.stage.renderer.domElement;
      this.page.picks(canvas, (x, y) => this.page.choose(this.stage.pick(x, y)));
    }
    const {step, lower, extent} = this.story.frames[frame];
    this.stage.show(places, {step, lower, extent});
  }
  // "7 of 256 particles differ".
  told(frame) {
    const count = this.difference.particles[frame], all = this.page.story.head.particles;
    return count === 0 ? "equal" : `${count} of ${all} particles differ`;
  }
  async tell(frame, place, id, still) {
    by_id("chosen-beside-part").hidden = place < 0;
    if (place < 0) return;
    this.exact = (await tell_particle(this.source, this.story, frame, place, id, by_id("chosen-beside"), still)) || this.exact;
    const texts = (table) => new Map([...table.rows].map((row) => [row.cells[0].innerText, row]));
    const first = texts(by_id("chosen"));
    for (const [name, row] of texts(by_id("chosen-beside"))) {
      const differs = first.get(name)?.innerText !== row.innerText;
      for (const one of [row, first.get(name)]) one?.classList.toggle("differs", differs);
    }
  }
}
