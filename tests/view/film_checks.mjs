// SPDX-License-Identifier: MIT
// Films that a page records: their pictures, and what stands in the first and the last.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {drawn, show} from "./browser.mjs";
import {read_webm} from "./webm.mjs";

const kPasses = 150;  // pictures of a step, at most

async function record(page) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#film")]);
  assert.equal(download.suggestedFilename(), "film.webm");
  const bytes = readFileSync(await download.path()), made = await page.evaluate(() => ({...cuboct.page.film.made, blob: undefined}));
  const film = read_webm(bytes);
  assert.deepEqual([film.width, film.height], [made.width, made.height]);
  const told = await page.textContent("#film-told");
  assert.ok(told.startsWith(`${film.times.length} pictures of ${film.width} × ${film.height}, ${made.rate} a second, `), told);
  assert.equal(await page.textContent("#film"), "record a film");
  assert.deepEqual(film.times, film.times.map((_, k) => Math.round((1000 * k) / made.rate)));
  assert.equal(film.duration, Math.round((1000 * film.times.length) / made.rate));
  return {...film, bytes};
}

// How many pixels of the film's first and last picture are not white, above the words.
async function inked(context, {bytes, width, height, duration, times}) {
  const player = await context.newPage();
  const counts = await player.evaluate(async ([data, width, height, seconds]) => {
    const video = document.createElement("video"), canvas = document.createElement("canvas"), counts = [];
    canvas.width = width, canvas.height = height;
    const pen = canvas.getContext("2d");
    const count = async (time) => {
      video.currentTime = time;
      await new Promise((done) => { video.onseeked = done; });
      pen.drawImage(video, 0, 0);
      const pixels = pen.getImageData(0, 0, width, Math.floor(0.93 * height)).data;
      let all = 0;
      for (let k = 0; k < pixels.length; k += 4) if (pixels[k] < 225 || pixels[k + 1] < 225 || pixels[k + 2] < 225) ++all;
      counts.push(all);
    };
    video.muted = true;
    video.src = "data:video/webm;base64," + data;
    await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(new Error(video.error.message)); });
    for (const time of seconds) await count(time);
    return counts;
  }, [bytes.toString("base64"), width, height, [0, times.length - 1].map((k) => ((k + 0.5) * duration) / times.length / 1000)]);
  await player.close();
  return counts;
}

export async function a_film_has_each_frame(page, context, frames) {
  await page.selectOption("#film-rate", "10");
  await show(page, frames - 1);
  const last = (await drawn(page)).inked;
  await show(page, 0);
  const first = (await drawn(page)).inked, film = await record(page);
  assert.equal(film.times.length, frames);
  assert.equal(await page.evaluate(() => cuboct.page.frame), frames - 1);
  const filmed = await inked(context, film);
  [first, last].forEach((shown, k) => assert.ok(Math.abs(filmed[k] - shown) < 0.1 * shown, `${filmed[k]} pixels in the film, ${shown} in the picture`));
  await show(page, frames >> 1);
  return film.times.length;
}

// The machine is shown. Of a film that is ended early the pictures so far stay.
export async function a_film_has_each_cycle(page) {
  const cycles = await page.evaluate(() => { const {machine} = cuboct.page; machine.show_cycle(machine.spans.length - 12); return machine.spans.length; });
  const by = Math.ceil(cycles / kPasses);  // from the twelfth before the end to the last
  assert.equal((await record(page)).times.length, Math.ceil(11 / by) + 1);
  await page.evaluate(() => {
    const {machine} = cuboct.page, show = machine.show_cycle.bind(machine);
    let count = 0;
    machine.show_cycle = (cycle) => { show(cycle); if (++count === 5) document.getElementById("film").click(); };
    show(0);
  });
  assert.equal((await record(page)).times.length, 5);
  await page.evaluate(() => { delete cuboct.page.machine.show_cycle; });
}
