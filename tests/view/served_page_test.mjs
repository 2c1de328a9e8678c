// SPDX-License-Identifier: MIT
// The server of `cuboct view`: whom it answers, what it withstands, a run that it follows and steers.
// usage: node served_page_test.mjs CUBOCT RUN NUMBERS SCENE OUT CHROMIUM STUDY_WEB [PICTURES]; ends with 1 where something is wrong.
// With - for CHROMIUM the server alone, without a page.
import assert from "node:assert/strict";
import {spawn} from "node:child_process";
import {existsSync, readFileSync, rmSync} from "node:fs";
import http from "node:http";
import net from "node:net";
import {fileURLToPath} from "node:url";
import {choose, drawn, kPatience, launch, open, show, too_wide} from "./browser.mjs";

const [cuboct, run, numbers, scene, out, chromium, study_web, pictures] = process.argv.slice(2);
const trace = JSON.parse(readFileSync(numbers, "utf8"));

// A `cuboct view`, once it has told its address.
async function view(...words) {
  const program = spawn(cuboct, ["view", ...words, "--no-open"], {stdio: ["ignore", "pipe", "pipe"]});
  programs.push(program);
  let told = "", errors = "";
  program.stderr.on("data", (text) => { errors += text; });
  const ended = new Promise((done) => program.on("exit", (code) => done(code)));
  const address = await new Promise((done, fail) => {
    program.stdout.on("data", (text) => {
      told += text;
      const found = told.match(/^http:\/\/127\.0\.0\.1:(\d+)\/([0-9a-f]{32})\/$/m);
      if (found) done({all: found[0], port: Number(found[1]), token: found[2]});
    });
    ended.then((code) => fail(new Error(`cuboct view ended with ${code}: ${errors}`)));
  });
  return {address, program, ended, told: () => told, errors: () => errors, end: () => { program.kill("SIGINT"); return ended; }};
}

// Of a test that fails: nothing goes on after it.
const programs = [];
process.on("exit", () => programs.forEach((program) => program.kill("SIGKILL")));

const ask = (port, path, options = {}) => new Promise((done, fail) => {
  const request = http.request({host: "127.0.0.1", port, path, ...options}, (answer) => {
    const parts = [];
    answer.on("data", (part) => parts.push(part));
    answer.on("end", () => done({status: answer.statusCode, headers: answer.headers, body: Buffer.concat(parts)}));
  });
  request.on("error", fail);
  request.end();
});

async function only_who_has_the_token_is_answered({port, token}) {
  const right = `/${token}/story`;
  assert.equal((await ask(port, right)).status, 200);
  for (const path of ["/", "/story", `/${token}`, `/${token.slice(1)}0/story`, `/${"0".repeat(32)}/story`, `/${token}/../story`, `/${token}//story`,
    `/${token}/frame/0`, `/${token}/frame/0/0/0`, `/${token}/frame/-1/0`, `/${token}/frame/999/0`, `/${token}/frame/0/99`,
    `/${token}/frame/0/2?row=99999999`, `/${token}/run.toml`, `/${token}/frame/18446744073709551616/0`])
    assert.equal((await ask(port, path)).status, 404, path);
  assert.equal((await ask(port, right, {headers: {Host: "example.org"}})).status, 404);
  assert.equal((await ask(port, right, {headers: {Host: `example.org:${port}`}})).status, 404);
  assert.equal((await ask(port, right, {method: "POST"})).status, 405);
  assert.equal((await ask(port, `/${token}/command/pause`)).status, 405);
  assert.equal((await ask(port, `/${token}/command/pause`, {method: "POST"})).status, 404);  // nothing goes that could pause
  assert.equal((await ask(port, right)).headers["referrer-policy"], "no-referrer");
  // Of the loopback alone.
  const sockets = readFileSync("/proc/net/tcp", "utf8").split("\n").map((line) => line.trim().split(/\s+/)[1] || "");
  const mine = sockets.filter((at) => at.endsWith(":" + port.toString(16).toUpperCase().padStart(4, "0")));
  assert.ok(mine.length > 0 && mine.every((at) => at.startsWith("0100007F:")), mine.join());
}

// Connections that say nothing, say half, or go while they are answered; the next is answered all the same.
async function drops_do_no_harm({port, token}) {
  let dropped = 0;
  for (let k = 0; k < 300; ++k)
    await new Promise((done) => {
      const socket = net.connect(port, "127.0.0.1", () => {
        if (k % 3 === 1) socket.write(`GET /${token}/frame/0/0 HTT`);
        if (k % 3 === 2) socket.write(`GET /${token}/frame/0/2 HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`);
        if (k % 2) setImmediate(() => socket.destroy()); else socket.resetAndDestroy();
      });
      socket.on("error", () => {});
      socket.on("close", () => { ++dropped; done(); });
    });
  assert.equal(dropped, 300);
  // Readers who take nothing of what they asked for.
  const slow = Array.from({length: 8}, () => {
    const socket = net.connect(port, "127.0.0.1");
    socket.on("error", () => {});
    socket.pause();
    socket.write(`GET /${token}/frame/0/2 HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`);
    return socket;
  });
  const all = await Promise.all(Array.from({length: 40}, () => ask(port, `/${token}/frame/0/0`)));
  assert.ok(all.every(({status, body}) => status === 200 && body.equals(all[0].body)));
  slow.forEach((socket) => socket.destroy());
}

async function the_server_alone() {
  const server = await view(run);
  await only_who_has_the_token_is_answered(server.address);
  await drops_do_no_harm(server.address);
  assert.equal(await server.end(), 0);
}

async function a_stored_run(browser) {
  const server = await view(run);
  const {page, problems, context} = await open(browser, server.address.all, 1280, 900);
  let compared = 0;
  for (const [k, frame] of trace.frames.entries()) {
    await show(page, k);
    for (const [n, id] of frame.ids.entries()) {
      const told = await choose(page, id);
      assert.deepEqual([told.exact.x, told.exact.v], [frame.x[n], frame.v[n]]);
      if (frame.words) assert.deepEqual(told.words, frame.words[n]);
      ++compared;
    }
  }
  assert.ok((await drawn(page)).inked > 500);
  if (pictures) await page.screenshot({path: `${pictures}/served.png`});
  assert.deepEqual(problems, []);
  await context.close();
  assert.equal(await server.end(), 0);
  return compared;
}

const state = (page) => page.evaluate(() => document.getElementById("live").dataset.state);
const frames = (page) => page.evaluate(() => cuboct.story.frames.length);
const until = (page, work, value) => page.waitForFunction(work, value);

// A run that never ends by itself: it is paused, goes one frame at a time, goes on though its page is closed, and is ended.
async function a_live_run(browser) {
  rmSync(out, {recursive: true, force: true});
  const server = await view(scene, "--steps", "3000000", "--frame-every", "50", "--out", out);
  let {page, problems, context} = await open(browser, server.address.all, 1280, 900);
  await until(page, (least) => cuboct.story.frames.length >= least, 3);
  await page.click("#pause");
  await until(page, () => document.getElementById("live").dataset.state === "paused");
  // Frames that were under way have come once two answers in turn have none.
  for (let before = -1, now = await frames(page); now !== before; now = await frames(page)) {
    before = now;
    await page.evaluate(() => cuboct.source.news(0, 0));
    await page.waitForTimeout(600);
  }
  const paused = await frames(page), step = await page.evaluate(() => cuboct.story.frames.at(-1).step);
  for (let k = 1; k <= 3; ++k) {
    await page.click("#step");
    await until(page, (count) => cuboct.story.frames.length === count, paused + k);
    assert.equal(await page.evaluate(() => cuboct.story.frames.at(-1).step), step + 50 * k);
  }
  await until(page, (frame) => cuboct.page.frame === frame, paused + 2);
  // Its curves end with the newest frame, as drawn.
  const live = await page.evaluate(() => cuboct.story.curves), last = step + 150;
  const drawn_to = await page.evaluate(() => cuboct.page.charts.map((chart) => chart.x.at(-1) / chart.dt));
  assert.ok(live.length > 0 && drawn_to.length === live.length);
  live.forEach((curve, k) => {
    assert.ok(curve.step.at(-1) <= last && curve.step.at(-1) > last - 50, `${curve.name} ends with ${curve.step.at(-1)} at ${last}`);
    assert.equal(Math.round(drawn_to[k]), curve.step.at(-1));
  });
  if (pictures) await page.screenshot({path: `${pictures}/live.png`});
  assert.deepEqual(problems, []);
  await page.click("#continue");
  await until(page, (count) => cuboct.story.frames.length > count, paused + 3);
  await context.close();
  ({page, problems, context} = await open(browser, server.address.all, 400, 860));  // the run goes on
  const again = await frames(page);
  assert.ok(again > paused + 3);
  // A page that comes late has them from the first on.
  const late = await page.evaluate(() => cuboct.story.curves);
  assert.deepEqual(late.map(({step}) => step[0]), live.map(() => 0));
  assert.ok(late[0].step.at(-1) > last);
  await until(page, (count) => cuboct.story.frames.length > count, again);
  assert.equal(await state(page), "running");
  problems.length = 0;
  await page.click("#end");
  // The page is then that of the run's directory, with its curves.
  await until(page, () => globalThis.cuboct?.story.live === false && cuboct.page.charts.length > 0);
  assert.deepEqual(problems.filter((text) => !text.startsWith("dialog: End the run")), []);
  assert.ok(existsSync(out + "/trace.h5"));
  // What was drawn while it went is what its trace has.
  const whole = await page.evaluate(() => cuboct.story.curves);
  for (const [k, {name, unit, step, value}] of [...live.entries(), ...late.entries()]) {
    const kept = new Map(whole[k].step.map((at, n) => [at, whole[k].value[n]]));
    assert.deepEqual([name, unit], [whole[k].name, whole[k].unit]);
    assert.ok(step.length > 1);
    step.forEach((at, n) => assert.equal(value[n], kept.get(at), `${name} at step ${at}`));
  }
  assert.match(readFileSync(out + "/run.toml", "utf8"), /state = ['"]interrupted['"]/);
  const kept = await frames(page);
  assert.ok(kept >= again);
  if (pictures) await page.screenshot({path: `${pictures}/ended.png`, fullPage: true});
  await context.close();
  assert.equal(await server.end(), 0);
  assert.ok(!existsSync(out + "/.view") && !existsSync(out + "/.lock"));
  return kept;
}

// `cuboct run` by itself; a page comes, goes, and the run is none the worse.
async function a_run_of_another_process(browser) {
  rmSync(out, {recursive: true, force: true});
  const other = spawn(cuboct, ["run", scene, "--steps", "3000000", "--frame-every", "50", "--frames", "none", "--out", out], {stdio: "ignore"});
  programs.push(other);
  const over = new Promise((done) => other.on("exit", done));
  const began = Date.now();
  while (!existsSync(out + "/run.toml") && Date.now() - began < kPatience) await new Promise((done) => setTimeout(done, 50));
  const first = await view(out);
  let {page, context} = await open(browser, first.address.all, 1280, 900);
  await until(page, () => cuboct.story.frames.length >= 2);
  await assert.rejects(view(out), /another cuboct view follows/);
  await page.click("#pause");
  await until(page, () => document.getElementById("live").dataset.state === "paused");
  await context.close();
  assert.equal(await first.end(), 0);  // a run whose page has gone is paused by nobody
  const second = await view(out);
  ({page, context} = await open(browser, second.address.all, 1280, 900));
  const seen = await page.evaluate(() => cuboct.story.frames.at(-1).step);
  await until(page, (step) => cuboct.story.frames.at(-1).step > step, seen);
  other.kill("SIGINT");
  assert.equal(await over, 1);
  await until(page, () => globalThis.cuboct?.story.live === false && cuboct.page.charts.length > 0);
  await context.close();
  assert.equal(await second.end(), 0);
}

// A velocity is changed in the page, then particles are pulled by mouse; steps are those of the whole run.
async function a_steered_run(browser) {
  rmSync(out, {recursive: true, force: true});
  const coupon = fileURLToPath(new URL("../../scenes/coupon.toml", import.meta.url));
  const server = await view(coupon, "--steer", "--steps", "100000", "--frame-every", "50", "--out", out);
  const {page, problems, context} = await open(browser, server.address.all, 1280, 900);
  await page.click("#pause");
  await until(page, () => document.getElementById("live").dataset.state === "paused");
  const inputs = await page.$$("#steer input");
  assert.equal(inputs.length, 7);  // a velocity, gravity, damping
  assert.equal(await inputs[0].inputValue(), "5");
  await inputs[1].fill("1e9");
  await page.click("#steer button");
  await until(page, () => /an imposed velocity is/.test(document.getElementById("steer-told").textContent));
  await inputs[1].fill("0"), await inputs[0].fill("-1");
  await page.click("#steer button");
  const told = (begin) => until(page, (begin) => document.getElementById("steer-told").textContent.startsWith(begin), begin);
  await told("pulled: [-1, 0, 0] soon.");
  await until(page, () => /The change is in force once the run goes on/.test(document.getElementById("steer-now").textContent));
  assert.equal(await too_wide(page) <= 0, true);
  await page.click("#step");
  await told("pulled: [-1, 0, 0] from step ");
  await until(page, () => document.getElementById("live").dataset.state === "paused");
  // From the middle of the picture upwards: the body is there.
  await page.check("#pull");
  await page.fill("#pull-steps", "100");
  const {x, y, width, height} = await (await page.$("#canvas")).boundingBox(), middle = [x + width / 2, y + height / 2];
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0], middle[1] - 60, {steps: 3});
  await page.evaluate(() => cuboct.page.stage.draw_whole());
  if (pictures) await page.screenshot({path: `${pictures}/pulled.png`});
  const way = await page.evaluate(([x, y]) => { const {hand} = cuboct.page.steer; return hand.way(x, y).multiplyScalar(cuboct.page.stage.size).toArray(); },
    [width / 2, height / 2 - 60]);
  await page.mouse.up();
  await told("particle ");
  await page.click("#continue");
  await until(page, () => / in 100 steps, from step \d+ on\.$/.test(document.getElementById("steer-told").textContent));
  // The hand has let go.
  await until(page, () => document.getElementById("steer-now").textContent.startsWith("Part 4, "));
  await until(page, () => cuboct.story.frames.at(-1).step >= 1000);
  await page.click("#end");
  await until(page, () => document.getElementById("live").dataset.state === "ended");
  const steps = await page.evaluate(() => cuboct.story.frames.map(({step}) => step)), last = steps.at(-1);
  assert.ok(steps.every((step, k) => k === 0 || step > steps[k - 1]) && last < 100000, steps.join());
  const curves = await page.evaluate(() => cuboct.story.curves.map(({step}) => step.at(-1)));
  assert.ok(curves.every((step) => step >= 1000 && step <= last), curves.join());
  await until(page, (told) => document.getElementById("steer-now").textContent === told, `The run ended at step ${last} of 100000, in 4 parts.`);
  const written = readFileSync(out + "/scene.toml", "utf8"), hand = written.match(/name = "hand", kind = "moved", velocity = "\[(.*?)\] m\/s"/);
  assert.ok(written.includes('velocity = "[-1, 0, 0] m/s"') && hand, written);
  // The way of the arrow, in 100 time steps.
  const dt = await page.evaluate(() => cuboct.story.head.dt);
  hand[1].split(", ").map(Number).forEach((v, k) => assert.ok(Math.abs(v * 100 * dt - way[k]) < 1e-9, hand[1] + " beside " + way));
  if (pictures) await page.screenshot({path: `${pictures}/steered.png`});
  assert.deepEqual(problems.filter((text) => !/400 \(Bad Request\)|^dialog: End the run/.test(text)), []);
  await context.close();
  assert.equal(await server.end(), 0);
  return steps.length;
}

await the_server_alone();
if (chromium !== "-") {
  const browser = await launch(chromium, study_web);
  try {
    console.log(`${await a_stored_run(browser)} particles of a stored run are those of its trace`);
    console.log(`${await a_live_run(browser)} frames of a live run`);
    await a_run_of_another_process(browser);
    console.log(`${await a_steered_run(browser)} frames of a steered run`);
  } finally {
    await browser.close();
  }
}
console.log("the server answers its reader alone");
