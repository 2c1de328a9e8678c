// SPDX-License-Identifier: MIT
// The picture of a report that the mouse turns, under the policy of its page.
// usage: node report_page_test.mjs REPORT CHROMIUM STUDY_WEB [PICTURES]; ends with 1 where something is wrong.
import assert from "node:assert/strict";
import {pathToFileURL} from "node:url";
import {launch, too_wide} from "./browser.mjs";

const [path, chromium, study_web, pictures] = process.argv.slice(2);

// The box of what is not white, its pixels, and how many are red and blue.
const seen = (page) => page.evaluate(() => {
  const canvas = document.getElementById("turn"), {width, height} = canvas, {data} = canvas.getContext("2d").getImageData(0, 0, width, height);
  const found = {left: width, right: 0, top: height, bottom: 0, inked: 0, red: 0, blue: 0};
  for (let k = 0; k < width * height; ++k) {
    const [r, g, b] = data.slice(4 * k, 4 * k + 3);
    if (r > 250 && g > 250 && b > 250) continue;
    const x = k % width, y = Math.floor(k / width);
    ++found.inked, found.red += r > b + 60, found.blue += b > r + 60;
    found.left = Math.min(found.left, x), found.right = Math.max(found.right, x), found.top = Math.min(found.top, y), found.bottom = Math.max(found.bottom, y);
  }
  return found;
});

const browser = await launch(chromium, study_web);
try {
  for (const [width, height] of [[1280, 900], [400, 860]]) {
    const page = await (await browser.newContext({viewport: {width, height}})).newPage(), problems = [];
    page.on("console", (message) => { if (!/willReadFrequently/.test(message.text())) problems.push(message.text()); });  // of the reading here
    page.on("pageerror", (error) => problems.push(error.stack));
    await page.goto(pathToFileURL(path).href);
    await page.waitForSelector("#turn", {state: "visible"});
    assert.ok(await too_wide(page) <= 0);
    const before = await seen(page);
    assert.ok(before.inked > 5000 && before.red > 100, JSON.stringify(before));
    assert.ok(before.left > 0 && before.right < 719 && before.top > 0 && before.bottom < 479, JSON.stringify(before));
    // Looked at from above, a bar that lies along x is as long as it is, and as high as it is wide.
    await page.evaluate(() => document.getElementById("turn").scrollIntoView({block: "center"}));
    const box = await (await page.$("#turn")).boundingBox(), x = box.x + box.width / 2, y = box.y + box.height / 2;
    const drag = async (dx, dy) => {
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + dx, y + dy, {steps: 5});
      await page.mouse.up();
      await page.waitForTimeout(100);
    };
    await drag(-60, 0);  // the yaw of 0.6 is undone
    const turned = await seen(page);
    assert.ok(turned.right - turned.left > before.right - before.left, "the bar is not seen from its side");
    await drag(0, box.height / 2 - 20);
    const above = await seen(page), extent = JSON.parse(await page.textContent("#turn-data")).extent;
    const ratio = (above.bottom - above.top) / (above.right - above.left);
    assert.ok(Math.abs(ratio - extent[1] / extent[0]) < 0.05, `${ratio}, ${extent}`);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, 500);
    await page.waitForTimeout(100);
    assert.ok((await seen(page)).inked < 0.7 * above.inked);
    assert.deepEqual(problems, []);
    if (pictures) await page.screenshot({path: `${pictures}/report_${width}.png`});
    await page.context().close();
  }
} finally {
  await browser.close();
}
console.log("the report's picture turns");
