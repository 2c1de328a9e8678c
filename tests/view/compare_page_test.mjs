// SPDX-License-Identifier: MIT
// A saved page of two runs beside the numbers of both traces.
// usage: node compare_page_test.mjs PAGE NUMBERS_A NUMBERS_B CHROMIUM STUDY_WEB [PICTURES]; numbers of all particles. Ends with 1 where something
// is wrong.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {basename} from "node:path";
import {pathToFileURL} from "node:url";
import {choose, launch, open, show, too_wide} from "./browser.mjs";

const [path, numbers_a, numbers_b, chromium, study_web, pictures] = process.argv.slice(2);
const [a, b] = [numbers_a, numbers_b].map((file) => JSON.parse(readFileSync(file, "utf8")));
const kAxes = ["x", "y", "z"];

// Frames of steps that both have.
const steps = a.frames.map(({step}) => step).filter((step) => b.frames.some((frame) => frame.step === step));
const both = steps.map((step) => [a, b].map(({frames}) => frames.find((frame) => frame.step === step)));

// The first component that differs: {field, axis, velocity}; null: none does.
function difference(frame_a, frame_b, id) {
  for (const [axis, name] of kAxes.entries())
    if (frame_a.cells[id][axis] !== frame_b.cells[id][axis] || frame_a.words[id][axis] !== frame_b.words[id][axis]) return {field: `position ${name}`, axis, velocity: false};
  for (const [axis, name] of kAxes.entries())
    if (frame_a.words[id][3 + axis] !== frame_b.words[id][3 + axis]) return {field: `velocity ${name}`, axis, velocity: true};
  return null;
}

async function the_first_difference_is_that_of_the_traces(page) {
  const told = await page.evaluate(() => cuboct.story.with.difference);
  let first = null;
  const counts = both.map(([frame_a, frame_b], frame) => frame_a.ids.filter((id) => {
    const found = difference(frame_a, frame_b, id);
    if (found && !first) first = {...found, frame, id};
    return found;
  }).length);
  assert.deepEqual(told.particles, counts);
  const text = await page.innerText("#difference-part");
  if (!first) {
    assert.equal(told.first, null);
    assert.ok(text.includes(`The runs are equal. Compared: ${both.length} frames of ${both[0][0].ids.length} particles`), text);
    return null;
  }
  const frames = both[first.frame], component = first.axis + (first.velocity ? 3 : 0);
  assert.equal(await page.innerText("#difference-where"), `step ${frames[0].step}, particle ${first.id}, ${first.field}`);
  const rows = new Map(await page.$$eval("#difference tr", (all) => all.map((row) => [row.cells[0].innerText, row.cells[1].innerText])));
  for (const [k, name] of ["A", "B"].entries()) {
    const frame = frames[k], word = frame.words[first.id][component], [value, unit] = rows.get(`${name}, value`).split(" ");
    assert.equal(Number(value), (first.velocity ? frame.v : frame.x)[first.id][first.axis]);
    assert.equal(unit, first.velocity ? "m/s" : "m");
    assert.equal(rows.get(`${name}, words`), first.velocity ? word : `cell ${frame.cells[first.id][first.axis]}, ${word}`);
    const bits = rows.get(`${name}, bits`).replaceAll(/\s/g, "");
    assert.equal(String(first.velocity ? BigInt.asIntN(bits.length, BigInt("0b" + bits)) : BigInt("0b" + bits)), word);
  }
  // The page begins with it.
  assert.deepEqual(await page.evaluate(() => [cuboct.page.frame, cuboct.page.chosen]), [first.frame, first.id]);
  return first;
}

// Both runs' particles, and their colours over one range.
async function numbers_are_those_of_both(page) {
  let compared = 0;
  for (const [k, frames] of both.entries()) {
    await show(page, k);
    for (const id of [0, frames[0].ids.length >> 1, frames[0].ids.length - 1]) {
      await choose(page, id);
      const exact = await page.evaluate(() => [cuboct.page.exact, cuboct.page.beside.exact].map(({x, v}) => [x, v]));
      frames.forEach((frame, run) => assert.deepEqual(exact[run], [frame.x[id], frame.v[id]], `particle ${id} of run ${"AB"[run]} at step ${frame.step}`));
      const red = await page.$$eval("#chosen-beside tr.differs", (all) => all.length);
      // Strains of a particle may differ where its own numbers do not.
      if (difference(frames[0], frames[1], id)) assert.ok(red > 0);
      if (await page.evaluate(() => cuboct.story.with.difference.first === null)) assert.equal(red, 0);
      ++compared;
    }
    const clouds = await page.evaluate(() => cuboct.page.stages().map(({cloud}) => [[...cloud.values], cloud.material.uniforms.range.value.toArray()]));
    assert.deepEqual(clouds[0][1], clouds[1][1]);
    frames.forEach(({speed}, run) => {
      const largest = Math.max(...speed, 1e-300);
      clouds[run][0].forEach((value, id) => assert.ok(Math.abs(value - speed[id]) <= 3e-7 * largest, `speed of ${id} in run ${"AB"[run]}`));
    });
  }
  return compared;
}

const cameras = (page) => page.evaluate(() => cuboct.page.stages().map(({camera}) => [...camera.position.toArray(), ...camera.quaternion.toArray()]));
const inked = (page) => page.evaluate(() => cuboct.page.stages().map((stage) => {
  stage.draw_whole();  // one that was turned just now may be coarse
  const gl = stage.renderer.getContext(), {width, height} = stage.renderer.domElement, data = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) if (data[k] < 250 || data[k + 1] < 250 || data[k + 2] < 250) ++count;
  return count;
}));

// Whichever picture is turned, both turn.
async function one_camera(page) {
  const same = ([first, second]) => first.forEach((value, k) => assert.ok(Math.abs(value - second[k]) < 1e-6, `${first} is not ${second}`));
  let before = await cameras(page);
  same(before);
  for (const id of ["canvas", "canvas-beside"]) {
    const box = await (await page.$("#" + id)).boundingBox(), x = box.x + box.width / 2, y = box.y + box.height / 2;
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 25, {steps: 3});
    await page.mouse.up();
    const after = await cameras(page);
    same(after);
    assert.ok(Math.hypot(...after[0].map((value, k) => value - before[0][k])) > 0.05, `${id} does not turn`);
    before = after;
  }
}

const browser = await launch(chromium, study_web);
try {
  for (const [width, height] of [[1280, 900], [400, 860]]) {
    const {page, problems, context} = await open(browser, pathToFileURL(path).href, width, height);
    await page.waitForFunction(() => cuboct.page.beside.stage);
    const captions = await page.$$eval(".caption", (all) => all.map((one) => one.textContent));
    captions.forEach((text, k) => assert.ok(text.startsWith("AB"[k]) && text.includes(basename([numbers_a, numbers_b][k], ".json")), text));
    if (width === 1280) {
      await the_first_difference_is_that_of_the_traces(page);
      if (pictures) await page.screenshot({path: `${pictures}/compared_1280.png`});
      await one_camera(page);
      console.log(`${await numbers_are_those_of_both(page)} particles of two runs are those of their traces`);
    }
    (await inked(page)).forEach((count) => assert.ok(count > 200, "nothing is drawn"));
    assert.ok((await too_wide(page)) <= 0);
    assert.equal(await page.isVisible("#problem"), false);
    if (pictures && width < 1000) await page.screenshot({path: `${pictures}/compared_400.png`, fullPage: true});
    assert.deepEqual(problems, []);
    await context.close();
  }
} finally {
  await browser.close();
}
