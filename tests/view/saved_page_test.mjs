// SPDX-License-Identifier: MIT
// A saved page of a run as a reader meets it, from file://, beside the numbers of its trace.
// usage: node saved_page_test.mjs PAGE NUMBERS CHROMIUM STUDY_WEB [PICTURES]; ends with 1 where something is wrong.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {pathToFileURL} from "node:url";
import {choose, drawn, launch, open, show} from "./browser.mjs";
import {a_film_has_each_frame} from "./film_checks.mjs";
import {the_machine_fits, the_machine_is_that_of_the_trace} from "./machine_checks.mjs";

const [path, numbers, chromium, study_web, pictures] = process.argv.slice(2);
const trace = JSON.parse(readFileSync(numbers, "utf8"));
let compared = 0;

async function numbers_are_those_of_the_trace(page) {
  assert.equal(await page.textContent("h1"), trace.title);
  assert.equal(await page.title(), trace.title);
  assert.equal(await page.evaluate(() => cuboct.story.frames.length), trace.frames.length);
  for (const [k, frame] of trace.frames.entries()) {
    await show(page, k);
    assert.ok((await page.textContent("#now")).includes(`step ${frame.step}`));
    for (const [n, id] of frame.ids.entries()) {
      const told = await choose(page, id);
      assert.deepEqual(told.exact.x, frame.x[n], `place of particle ${id} at step ${frame.step}`);
      assert.deepEqual(told.exact.v, frame.v[n], `velocity of particle ${id} at step ${frame.step}`);
      if (frame.words) {
        assert.deepEqual(told.words, frame.words[n]);
        assert.deepEqual(told.exact.cell, frame.cells[n]);
        // Bits as they stand there, read as two's complement.
        const bits = [...told.exact.bits.x.map((text) => BigInt("0b" + text.replaceAll(" ", ""))),
          ...told.exact.bits.v.map((text) => BigInt.asIntN(text.replaceAll(" ", "").length, BigInt("0b" + text.replaceAll(" ", ""))))];
        assert.deepEqual(bits.map(String), frame.words[n]);
      }
      // And as the table has them: ten digits.
      const shown = told.text.match(/^position\t(.*)$/m)[1].trim().split(/\s+/).slice(0, 3).map(Number);
      shown.forEach((value, axis) => assert.ok(Math.abs(value - frame.x[n][axis]) <= 1e-9 * Math.abs(frame.x[n][axis]), `${value} is not ${frame.x[n][axis]}`));
      assert.ok(told.text.includes(trace.types[frame.types[id]].split("/")[0]));
      ++compared;
    }
  }
}

// Fields are floats: the speed of each particle is that of the trace to their 24 bits.
async function fields_are_those_of_the_trace(page) {
  await page.selectOption("#colour", {label: "speed"});
  for (const [k, frame] of trace.frames.entries()) {
    await show(page, k);
    const values = await page.evaluate(() => [...cuboct.page.stage.cloud.values]);
    const largest = Math.max(...frame.speed, 1e-300);
    values.forEach((value, id) => assert.ok(Math.abs(value - frame.speed[id]) <= 3e-7 * largest, `speed of ${id}: ${value}, ${frame.speed[id]}`));
    // Places to half a step of their 16 bits.
    const places = await page.evaluate(() => {
      const {lower, extent} = cuboct.story.frames[cuboct.page.frame];
      return [...cuboct.page.stage.cloud.places].map((q, n) => lower[n % 3] + (q / 65534) * extent[n % 3]);
    });
    const extent = await page.evaluate(() => cuboct.story.frames[cuboct.page.frame].extent);
    frame.places.flat().forEach((x, n) => assert.ok(Math.abs(places[n] - x) <= 0.501 * extent[n % 3] / 65534 + 1e-15 * Math.abs(x)));
    compared += values.length;
  }
}

async function curves_are_those_of_the_trace(page) {
  const names = Object.keys(trace.curves).filter((name) => trace.curves[name][0].length > 0).sort();
  assert.ok(names.length > 0);
  const charts = await page.evaluate(() => cuboct.page.charts.map(({curve}) => [curve.name, curve.step, curve.value]));
  assert.deepEqual(charts.map(([name]) => name).sort(), names);
  for (const [name, steps, values] of charts) assert.deepEqual([steps, values], trace.curves[name]);
  const last = trace.frames.length - 1;
  await show(page, last);
  const readings = await page.$$eval("#curves .reading", (all) => all.map((one) => Number(one.textContent)));
  charts.forEach(([, steps, values], k) => {
    const at = steps.findLastIndex((step) => step <= trace.frames[last].step);
    assert.ok(Math.abs(readings[k] - values[at]) <= 1e-4 * Math.abs(values[at]));
  });
}

// The pixel in the middle of a disc has its value's colour, unshaded.
async function pixels_have_the_colours_of_values(page) {
  await page.selectOption("#colour", {label: "speed"});
  const k = trace.frames.length - 1, {speed} = trace.frames[k];
  await show(page, k);
  await page.evaluate(() => cuboct.page.choose(-1));
  // Between the values that a third and two thirds of the particles are below, so that many have the scale's ends.
  const sorted = [...speed].sort((a, b) => a - b), range = {low: sorted[Math.floor(speed.length / 3)], high: sorted[Math.floor((2 * speed.length) / 3)]};
  await page.evaluate(({low, high}) => cuboct.page.stage.cloud.range(low, high), range);
  const ids = speed.map((_, id) => id);
  const lines = (visible) => page.evaluate((visible) => cuboct.page.stage.scene.traverse((one) => { if (one.isLineSegments) one.visible = visible; }), visible);
  await lines(false);  // of a box that repeats: they go over particles
  const picture = await drawn(page, ids);
  await lines(true);
  let checked = 0;
  for (const id of ids) {
    // Only discs that nothing covers: picking says which particle is seen there.
    const {x, y, colour} = picture.at[id];
    const seen = await page.evaluate(([x, y]) => {
      const {stage} = cuboct.page, scale = stage.renderer.domElement.clientWidth / stage.renderer.domElement.width;
      return stage.pick(x * scale, (stage.renderer.domElement.height - y) * scale);
    }, [x + 0.5, y + 0.5]);
    if (seen !== id) continue;
    const share = Math.min(1, Math.max(0, (speed[id] - range.low) / (range.high - range.low)));
    const expected = share === 0 ? [68, 1, 84] : share === 1 ? [253, 231, 37] : null;  // viridis' ends
    if (expected) {
      expected.forEach((channel, c) => assert.ok(Math.abs(channel - colour[c]) <= 6, `particle ${id}: ${colour}, expected ${expected}`));
      ++checked;
    }
  }
  assert.ok(checked >= 10, `only ${checked} particles of the range's ends are seen`);
  return checked;
}

async function a_cut_takes_a_part(page) {
  const whole = (await drawn(page)).inked;
  const cut = async (at, turned) => {
    await page.evaluate(([at, turned]) => {
      document.getElementById("cut-axis").value = "x";
      document.getElementById("cut-at").value = at;
      document.getElementById("cut-turn").checked = turned;
      cuboct.page.cut();
    }, [at, turned]);
    return (await drawn(page)).inked;
  };
  assert.equal(await cut(1, false), whole);
  const half = await cut(0.5, false), other = await cut(0.5, true), none = await cut(0, false);
  assert.ok(half > 0.1 * whole && half < 0.95 * whole, `${half} of ${whole} pixels are left of a cut`);
  assert.ok(other > 0.1 * whole && other < 0.95 * whole);
  assert.ok(half + other >= 0.9 * whole, "both sides together are all");
  assert.ok(none < 0.1 * whole);
  await page.evaluate(() => { document.getElementById("cut-axis").value = ""; cuboct.page.cut(); });
  assert.equal((await drawn(page)).inked, whole);
}

// A moving picture of many particles has a part of them, spread over all, and larger.
async function a_part_stands_for_the_whole(page) {
  const whole = (await drawn(page)).inked, count = trace.frames[0].speed.length;
  await page.evaluate(() => { Object.assign(cuboct.page.stage, {moving: true, held: true, share: 0.25, learn() {}}); });
  const part = (await drawn(page)).inked;
  assert.equal(await page.evaluate(() => cuboct.page.stage.drawn_particles), Math.ceil(count / 4));
  assert.ok(part > 0.6 * whole && part < 1.5 * whole, `${part} of ${whole} pixels`);
  await page.evaluate(() => { cuboct.page.stage.held = cuboct.page.stage.moving = false; delete cuboct.page.stage.learn; });
  assert.equal((await drawn(page)).inked, whole);
}

// Where the least part is slow, fewer pixels are drawn; at rest all are.
async function a_slow_picture_is_coarse(page) {
  const [whole, coarse, again, rest] = await page.evaluate(() => {
    const {stage} = cuboct.page, wide = () => (stage.draw_now(), stage.renderer.domElement.width), learn = (took, times) => {
      for (let k = 0; k < 3 * times; ++k) stage.learn(took);
    }, whole = wide();
    Object.assign(stage, {moving: true, held: true, last: 0, share: 1, times: []});
    learn(100, 20);
    const learnt = stage.learn;
    stage.learn = () => {};
    const coarse = wide();
    stage.learn = learnt;
    learn(5, 20);
    stage.learn = () => {};
    const again = wide();
    stage.held = stage.moving = false;
    stage.sharp = 0.5;
    const rest = wide();
    stage.sharp = 1;
    delete stage.learn;
    return [whole, coarse, again, rest];
  });
  assert.deepEqual([coarse, again, rest], [Math.floor(whole / 4), whole, whole]);
}

async function a_click_picks(page) {
  const ids = trace.frames[0].ids, picture = await drawn(page, ids), box = await (await page.$("#canvas")).boundingBox();
  const scale = box.width / picture.width, {x, y} = picture.at[3];
  await page.mouse.click(box.x + (x + 0.5) * scale, box.y + box.height - (y + 0.5) * scale);
  await page.waitForFunction(() => cuboct.page.chosen >= 0 && document.querySelector("#chosen td")?.innerText.trim() === String(cuboct.page.chosen));
  const front = await page.evaluate(() => cuboct.page.chosen);
  // What is picked is drawn over the others there, so its disc holds the point.
  const [{x: x_front, y: y_front}] = (await drawn(page, [front])).at;
  const reach = await page.evaluate(() => {
    const {stage} = cuboct.page, {radius, pixels} = stage.cloud.material.uniforms;
    return (2 * radius.value * pixels.value) / stage.camera.position.length();  // twice a disc's radius in the middle of the body
  });
  assert.ok(Math.hypot(x_front - x, y_front - y) <= reach, `particle ${front} is ${Math.hypot(x_front - x, y_front - y)} pixels from the click`);
  await page.mouse.click(box.x + 3, box.y + 3);
  await page.waitForSelector("#chosen-none", {state: "visible"});
}

async function time_goes_both_ways(page) {
  const now = () => page.evaluate(() => cuboct.page.frame);
  await show(page, 0);
  await page.click("#next");
  await page.waitForFunction(() => cuboct.page.frame === 1);
  await page.click("#back");
  await page.waitForFunction(() => cuboct.page.frame === 0);
  await page.click("#play");
  await page.waitForFunction((last) => cuboct.page.frame === last, trace.frames.length - 1);
  await page.waitForFunction(() => document.getElementById("play").textContent === "play");
  await page.fill("#time", "1");
  await page.waitForFunction(() => cuboct.page.frame === 1);
  assert.equal(await now(), 1);
}

const browser = await launch(chromium, study_web);
try {
  const address = pathToFileURL(path).href;
  for (const [width, height] of [[1280, 900], [400, 860]]) {
    const {page, problems, context} = await open(browser, address, width, height);
    if (width === 1280) {
      await numbers_are_those_of_the_trace(page);
      await fields_are_those_of_the_trace(page);
      await curves_are_those_of_the_trace(page);
      console.log(`${await pixels_have_the_colours_of_values(page)} pixels have their values' colours`);
      await a_cut_takes_a_part(page);
      await a_part_stands_for_the_whole(page);
      await a_slow_picture_is_coarse(page);
      await a_click_picks(page);
      await time_goes_both_ways(page);
      console.log(`${await a_film_has_each_frame(page, context, trace.frames.length)} pictures of a film`);
      if (trace.machine) console.log(`${await the_machine_is_that_of_the_trace(page, trace, pictures)} numbers of the machine are those of the trace`);
    }
    assert.equal(await page.isVisible("#live"), false);
    assert.equal(await page.isVisible("#problem"), false);
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    assert.ok(overflow <= 0, `${overflow} pixels too wide at ${width}`);
    assert.ok((await drawn(page)).inked > 500, "nothing is drawn");
    await choose(page, 0);
    if (pictures) await page.screenshot({path: `${pictures}/saved_${width}.png`, fullPage: width < 1000});
    if (trace.machine && width < 1000) await the_machine_fits(page, pictures);
    assert.deepEqual(problems, []);
    await context.close();
  }
} finally {
  await browser.close();
}
console.log(`${compared} numbers of the page are those of the trace`);
