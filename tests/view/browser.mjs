// SPDX-License-Identifier: MIT
// Pages of runs in headless Chromium, which draws WebGL in software unless CUBOCT_ANGLE names another backend of ANGLE, as gl-egl.
import {createRequire} from "node:module";

const kAngle = process.env.CUBOCT_ANGLE, kDrawing = kAngle ? [`--use-angle=${kAngle}`, "--ignore-gpu-blocklist"] :
  ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const kFlags = ["--headless", "--no-sandbox", ...kDrawing, "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];
export const kPatience = 120000;  // ms: what a busy machine may take

export function launch(chromium_path, study_web) {
  const {chromium} = createRequire(study_web + "/")("playwright-core");
  return chromium.launch({executablePath: chromium_path, args: kFlags});
}

// A page, and what went wrong in it: words of the console, errors, dialogs, requests elsewhere than `allowed`.
export async function open(browser, address, width, height, allowed = address) {
  const context = await browser.newContext({viewport: {width, height}});
  const page = await context.newPage(), problems = [];
  page.setDefaultTimeout(kPatience);
  // SwiftShader tells of slow reads, which are those of the test.
  page.on("console", (message) => { if (!/GPU stall due to ReadPixels/.test(message.text())) problems.push(`console ${message.type()}: ${message.text()}`); });
  page.on("pageerror", (error) => problems.push(`error: ${error.stack}`));
  page.on("dialog", (dialog) => { problems.push(`dialog: ${dialog.message()}`); dialog.accept(); });
  page.on("request", (request) => {
    if (!request.url().startsWith(allowed) && !/^(data|blob):/.test(request.url())) problems.push(`request: ${request.url()}`);
  });
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById("ready").hidden);
  return {page, problems, context};
}

// Whether anything is wider than the screen.
export const too_wide = (page) => page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);

export const show = (page, frame) => page.evaluate((k) => cuboct.page.show(k), frame);
export async function choose(page, place) {
  await page.evaluate((k) => cuboct.page.choose(k), place);
  return page.evaluate(() => ({exact: {...cuboct.page.exact, words: undefined}, words: cuboct.page.exact.words &&
    [...cuboct.page.exact.words.x, ...cuboct.page.exact.words.v].map(String), text: document.getElementById("chosen").innerText}));
}

// What is drawn, of the canvas' pixels from the bottom: {width, height, data}, and where particles stand in them.
export const drawn = (page, ids = []) => page.evaluate((ids) => {
  const {stage} = cuboct.page, gl = stage.renderer.getContext();
  if (!stage.held) stage.moving = false;  // a picture that was turned just now may be coarse
  stage.draw_now();
  const {width, height} = stage.renderer.domElement;
  const data = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  const at = ids.map((id) => {
    const {lower, extent} = stage.cloud.material.uniforms, places = stage.cloud.places, p = stage.camera.position.clone();
    p.set(places[3 * id], places[3 * id + 1], places[3 * id + 2]).divideScalar(65534).multiply(extent.value).add(lower.value).project(stage.camera);
    const x = Math.floor(((p.x + 1) / 2) * width), y = Math.floor(((p.y + 1) / 2) * height), from = 4 * (y * width + x);
    return {x, y, colour: [...data.slice(from, from + 3)]};
  });
  let inked = 0;
  for (let k = 0; k < data.length; k += 4) if (data[k] < 250 || data[k + 1] < 250 || data[k + 2] < 250) ++inked;
  return {width, height, inked, at};
}, ids);
