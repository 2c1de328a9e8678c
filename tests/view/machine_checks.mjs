// SPDX-License-Identifier: MIT
// The machine of a saved page beside the cycles of its trace: numbers, names, arrows, pixels, a picked node.
import assert from "node:assert/strict";
import {drawn, show} from "./browser.mjs";
import {a_film_has_each_cycle} from "./film_checks.mjs";

const kColours = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#999999"];
const kKinds = ["exchange_x", "exchange_y", "exchange_z", "force", "update", "migrate_x", "migrate_y", "migrate_z"];
const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

// The neighbour of a cell over a face, from coordinates alone.
function neighbours_of({cells, period}) {
  const at = new Map(cells.map((cell, n) => [cell.join(), n]));
  return cells.map((cell) => [0, 1, 2, 3, 4, 5].map((face) => {
    const k = face >> 1, other = [...cell];
    other[k] += face % 2 ? 1 : -1;
    if (period[k]) other[k] = (other[k] + period[k]) % period[k];
    return at.get(other.join()) ?? -1;
  }));
}

class Step {
  constructor(machine, step) {
    this.phases = machine.phases;
    this.spans = machine.cycles[step];
    this.around = (machine.around ??= neighbours_of(machine));
    this.base = Math.min(...this.spans.flat().map(([first]) => first));
    this.length = Math.max(...this.spans.flat().map(([, last]) => last)) + 1 - this.base;
  }
  axis(p) { return /^(exchange|migrate)_/.test(this.phases[p]) ? "xyz".indexOf(this.phases[p].split("_")[1][0]) : -1; }
  cycles(n, p) { return this.spans[n][p][1] + 1 - this.spans[n][p][0]; }
  // [face, node, the first cycle of its phase], of those that begin later.
  late(n, p) {
    const axis = this.axis(p);
    if (axis < 0 || this.cycles(n, p) === 0) return [];
    const others = [2 * axis, 2 * axis + 1].map((face) => [face, this.around[n][face]]);
    return others.filter(([, m]) => m >= 0 && m !== n && this.spans[m][p][0] > this.spans[n][p][0]).map(([face, m]) => [face, m, this.spans[m][p][0]]);
  }
  wait(n, p) {
    const late = this.late(n, p).map(([, , from]) => from - this.spans[n][p][0]);
    return Math.max(0, ...late);
  }
  wait_of(n) { return this.phases.reduce((sum, _, p) => sum + this.wait(n, p), 0); }
  begin_of(n) { return Math.min(...this.spans[n].map(([first]) => first)) - this.base; }
  end_of(n) { return Math.max(...this.spans[n].map(([, last]) => last)) + 1 - this.base; }
  phase_at(n, cycle) {
    const now = this.base + cycle, p = this.spans[n].findIndex(([first, last]) => first <= now && now <= last);
    return p >= 0 ? p : cycle < this.begin_of(n) ? -1 : this.phases.length;
  }
}

const take = (page, what, label) => page.selectOption(what, {label});
async function show_machine(page) {
  await take(page, "#what", "the machine");
  await page.waitForFunction(() => cuboct.page.nodes_shown());
}
const values = (page) => page.evaluate(() => [...cuboct.page.stage.nodes.values]);

async function numbers(page, trace) {
  const {machine} = trace, nodes = machine.cells.length;
  let compared = 0;
  for (const [k, frame] of trace.frames.entries()) {
    await show(page, k);
    await take(page, "#machine-colour", "particles held");
    assert.deepEqual(await values(page), machine.held[k], `particles held at step ${frame.step}`);
    const step = Math.min(frame.step, machine.cycles.length - 1), of = new Step(machine, step);
    assert.equal(await page.textContent("#step-now"), `step ${step}`);
    const all = [...Array(nodes).keys()];
    const expected = {"cycles of the step": (n) => of.end_of(n) - of.begin_of(n), "wait for late neighbours": (n) => of.wait_of(n),
      "start of the step": (n) => of.begin_of(n)};
    machine.phases.forEach((name, p) => { expected[name.replaceAll("_", " ")] = (n) => of.cycles(n, p); });
    for (const [label, value] of Object.entries(expected)) {
      await take(page, "#machine-colour", label);
      assert.deepEqual(await values(page), all.map(value), `${label} in step ${step}`);
      compared += nodes;
    }
    // Nothing ends before what it waits for has begun: the page's waits are real.
    for (const n of all)
      for (const p of machine.phases.keys())
        for (const [, , from] of of.late(n, p)) assert.ok(from <= of.spans[n][p][1], `node ${n} ends ${machine.phases[p]} before its neighbour begins it`);
  }
  assert.ok(trace.frames.some((_, k) => new Set(machine.held[k]).size > 1));
  return compared;
}

async function phases_of_a_cycle(page, trace) {
  const {machine} = trace, step = trace.frames[1].step, of = new Step(machine, step), nodes = machine.cells.length;
  await show(page, 1);
  await take(page, "#machine-colour", "phase in a cycle");
  let waited = 0;
  for (const cycle of [0, 1, Math.floor(of.length / 4), Math.floor(of.length / 2), Math.floor((3 * of.length) / 4), of.length - 1]) {
    await page.fill("#at-cycle", String(cycle));
    await page.waitForFunction((cycle) => cuboct.page.machine.cycle === cycle, cycle);
    assert.equal(await page.textContent("#cycle-now"), `cycle ${cycle} of ${of.length}, of the run ${of.base + cycle}`);
    const counts = new Array(machine.phases.length + 2).fill(0);
    let arrows = 0, waiting = 0;
    for (let n = 0; n < nodes; ++n) {
      const p = of.phase_at(n, cycle);
      ++counts[p < 0 ? machine.phases.length + 1 : p];
      const late = p < 0 || p >= machine.phases.length ? [] : of.late(n, p).filter(([, , from]) => of.base + cycle < from);
      arrows += late.length;
      waiting += late.length > 0;
    }
    const told = await page.evaluate(() => [cuboct.page.machine.counts, cuboct.page.machine.waiting, cuboct.page.stage.nodes.pointed]);
    assert.deepEqual(told, [counts, waiting, arrows], `cycle ${cycle}`);
    const legend = await page.$$eval("#types li", (all) => all.map((one) => one.textContent));
    counts.forEach((count, k) => {
      const name = [...machine.phases, "past this step", "before this step"][k].replaceAll("_", " ");
      if (count > 0) assert.ok(legend.includes(`${name}: ${count}`), `${name}: ${count} in ${legend}`);
    });
    assert.ok(legend.includes(`dark, with arrows to whom they wait for: ${waiting}`));
    waited += waiting;
  }
  return waited;
}

// The middle of a box's front has its phase's colour, darker where it waits.
async function pixels(page, trace) {
  const {machine} = trace, of = new Step(machine, trace.frames[1].step);
  await page.click("[data-look=x]");
  let checked = 0, dark = 0;
  for (let cycle = 0; cycle < of.length; cycle += Math.max(1, Math.floor(of.length / 12))) {
    await page.fill("#at-cycle", String(cycle));
    await page.waitForFunction((cycle) => cuboct.page.machine.cycle === cycle, cycle);
    const seen = await page.evaluate(() => {
      const {stage} = cuboct.page, {nodes} = stage, gl = stage.renderer.getContext();
      if (nodes.shown) nodes.shown.visible = false;  // arrows go over boxes
      stage.moving = false;
      stage.draw_now();
      const {width, height, clientWidth} = stage.renderer.domElement;
      const data = new Uint8Array(4 * width * height), found = [];
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
      for (let n = 0; n < nodes.count; ++n) {
        const p = stage.camera.position.clone();
        p.fromArray(nodes.centres, 3 * n), p.x += nodes.sides[0] / 2;
        p.project(stage.camera);
        const x = Math.floor(((p.x + 1) / 2) * width), y = Math.floor(((p.y + 1) / 2) * height), scale = clientWidth / width, from = 4 * (y * width + x);
        if (stage.pick_node((x + 0.5) * scale, (height - y - 0.5) * scale) === n) found.push([n, [...data.slice(from, from + 3)]]);
      }
      return found;
    });
    for (const [n, colour] of seen) {
      const p = of.phase_at(n, cycle), within = p >= 0 && p < machine.phases.length;
      const name = within ? machine.phases[p].split(" ")[0] : "";
      const waits = within && of.late(n, p).some(([, , from]) => of.base + cycle < from);
      const plain = channels(within ? kColours[kKinds.indexOf(name)] : p < 0 ? "#e6e9eb" : "#b9bfc4");
      plain.forEach((channel, c) => assert.ok(Math.abs(channel * (waits ? 0.45 : 1) - colour[c]) <= 4,
        `node ${n} in cycle ${cycle}, ${name}${waits ? ", waits" : ""}: ${colour}, expected ${plain}`));
      ++checked, dark += waits;
    }
  }
  assert.ok(checked >= 20 && dark >= 1, `${checked} boxes are seen, ${dark} of them wait`);
  return checked;
}

// A click picks the node that is seen there; its table has the recorded cycles.
async function a_click_tells_a_node(page, trace) {
  const {machine} = trace, step = trace.frames[1].step, of = new Step(machine, step);
  const box = await (await page.$("#canvas")).boundingBox();
  const [node, x, y] = await page.evaluate(() => {
    const {stage} = cuboct.page, {nodes} = stage, {clientWidth, clientHeight} = stage.renderer.domElement;
    for (let n = 0; n < nodes.count; ++n) {
      const p = stage.camera.position.clone();
      p.fromArray(nodes.centres, 3 * n).project(stage.camera);
      const x = ((p.x + 1) / 2) * clientWidth, y = ((1 - p.y) / 2) * clientHeight;
      if (cuboct.page.machine.held[n] > 0 && stage.pick_node(x, y) === n) return [n, x, y];
    }
    return null;
  });
  await page.mouse.click(box.x + x, box.y + y);
  await page.waitForFunction((n) => cuboct.page.machine.chosen === n, node);
  const text = await page.innerText("#node");
  assert.ok(text.includes(`${machine.held[1][node]} at step ${step}`), text);
  assert.ok(text.includes(`${of.end_of(node) - of.begin_of(node)} cycles`) && text.includes(`${of.wait_of(node)} cycles`), text);
  const rows = await page.$$eval("#node .phases tr", (all) => all.slice(1).map((row) => [...row.cells].map((cell) => cell.innerText.trim())));
  const expected = machine.phases.map((name, p) => [name.replaceAll("_", " "), ...of.spans[node][p], of.cycles(node, p), of.axis(p) < 0 ? "" : of.wait(node, p)].map(String))
    .filter(([, , , cycles]) => cycles !== "0");
  assert.deepEqual(rows, expected);
  // A bar for each phase of the node and its neighbours, and one for each wait.
  const rows_of = [node, ...of.around[node].filter((m) => m >= 0 && m !== node)];
  let bars = 0;
  for (const n of rows_of) for (const p of machine.phases.keys()) bars += (of.cycles(n, p) > 0) + (of.wait(n, p) > 0);
  assert.equal(await page.$$eval("#timeline rect", (all) => all.length), bars);
  await page.mouse.click(box.x + 3, box.y + 3);
  await page.waitForSelector("#node-none", {state: "visible"});
  return node;
}

async function cycles_play(page) {
  await page.evaluate(() => { const {machine} = cuboct.page; machine.cycle = machine.spans.length - 20; machine.colour(); });
  await page.click("#play-cycles");
  await page.waitForFunction(() => cuboct.page.machine.cycle === cuboct.page.machine.spans.length - 1 && document.getElementById("play-cycles").textContent === "play cycles");
}

// On a small screen nothing is wider than it.
export async function the_machine_fits(page, pictures) {
  await show_machine(page);
  await page.evaluate(() => cuboct.page.machine.choose(0));
  assert.ok((await drawn(page)).inked > 500);
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
  assert.ok(overflow <= 0, `${overflow} pixels too wide`);
  if (pictures) await page.screenshot({path: `${pictures}/machine_400.png`, fullPage: true});
  await take(page, "#what", "particles");
}

export async function the_machine_is_that_of_the_trace(page, trace, pictures) {
  const before = (await drawn(page)).inked, {machine} = trace;
  await show_machine(page);
  assert.equal(await page.isVisible("#colour"), false);
  const compared = await numbers(page, trace);
  assert.ok(await phases_of_a_cycle(page, trace) > 0, "nobody waits");
  const boxes = await pixels(page, trace);
  await page.click("[data-look=corner]");
  const node = await a_click_tells_a_node(page, trace);
  // A plane takes a part of the boxes.
  const whole = (await drawn(page)).inked;
  await page.evaluate(() => { document.getElementById("cut-at").value = 0.5; document.getElementById("cut-turn").checked = false; });
  await take(page, "#cut-axis", "x");
  const half = (await drawn(page)).inked;
  assert.ok(half < 0.97 * whole && half > 0.1 * whole, `${half} of ${whole} pixels`);
  await take(page, "#cut-axis", "no cut");
  // Each step that the page has is there by its number.
  const steps = await page.evaluate(() => cuboct.story.machine.kept ?? cuboct.story.machine.steps);
  assert.equal(steps, machine.cycles.length);
  await page.fill("#at-step", "17");
  await page.waitForFunction(() => document.getElementById("step-now").textContent === "step 17");
  assert.equal(await page.evaluate(() => cuboct.page.machine.spans.base), new Step(machine, 17).base);
  const per_step = await page.evaluate(() => cuboct.story.machine.per_step);
  const ends = machine.cycles.map((nodes) => Math.max(...nodes.flat().map(([, last]) => last)) + 1);
  assert.deepEqual(per_step.value, ends.map((end, k) => end - (k > 0 ? ends[k - 1] : 0)));
  await cycles_play(page);
  await a_film_has_each_cycle(page);
  if (pictures) {
    await page.evaluate(([node, cycle]) => { cuboct.page.machine.choose(node); cuboct.page.machine.cycle = cycle; cuboct.page.machine.colour(); }, [node, 40]);
    await page.screenshot({path: `${pictures}/machine_1280.png`});
    await page.evaluate(() => cuboct.page.machine.choose(-1));
  }
  await take(page, "#what", "particles");
  assert.equal(await page.isVisible("#node-section"), false);
  assert.equal((await drawn(page)).inked, before);
  console.log(`${boxes} boxes have their phases' colours`);
  return compared;
}
