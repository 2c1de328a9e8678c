// SPDX-License-Identifier: MIT
// A film of a page: as many pictures as frames, of the size of what was seen, and not blank.
import assert from "node:assert/strict";

const kCluster = 0x1f43b675, kSegment = 0x18538067, kBlock = 0xa3, kGroup = 0xa0;

// Pictures in a WebM: its simple blocks and groups. Lengths of live clusters may be unknown: all bits 1.
function pictures_in(bytes) {
  let at = 0, count = 0;
  const number = (keep) => {
    const first = bytes[at], length = Math.clz32(first) - 23;
    let value = keep ? first : first & ((1 << (8 - length)) - 1), ones = value === (1 << (8 - length)) - 1;
    for (let k = 1; k < length; ++k) value = value * 256 + bytes[at + k], ones &&= bytes[at + k] === 255;
    at += length;
    return !keep && ones ? Infinity : value;
  };
  while (at < bytes.length) {
    const id = number(true), size = number(false);
    if (id === kSegment || id === kCluster) continue;  // what they hold follows
    if (id === kBlock || id === kGroup) ++count;
    at += size;
  }
  return count;
}

export async function a_film_has_its_frames(page, frames) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#film")]);
  assert.equal(download.suggestedFilename(), "film.webm");
  const told = await page.evaluate(async () => {
    const {blob, count} = cuboct.page.filmed, {width, height} = cuboct.page.stage.renderer.domElement;
    return {count, width, height, bytes: [...new Uint8Array(await blob.arrayBuffer())]};
  });
  assert.equal(told.count, frames);
  const bytes = Uint8Array.from(told.bytes), found = pictures_in(bytes);
  assert.deepEqual([...bytes.slice(0, 4)], [0x1a, 0x45, 0xdf, 0xa3]);
  assert.ok(found >= 1 && found <= frames + 2, `${found} pictures of ${frames} frames`);  // a slow machine leaves some out
  // Read back, in a page of its own: that of a run loads nothing.
  const other = await page.context().newPage();
  const seen = await other.evaluate(async (text) => {
    const video = document.createElement("video");
    video.muted = true;
    video.src = "data:video/webm;base64," + text;
    await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(new Error(video.error.message)); });
    const canvas = document.createElement("canvas");
    canvas.width = video.videoWidth, canvas.height = video.videoHeight;
    const pen = canvas.getContext("2d");
    pen.drawImage(video, 0, 0);
    const data = pen.getImageData(0, 0, canvas.width, canvas.height).data, inked = [0, 0];
    for (let k = 0; k < data.length; k += 4)
      if (data[k] < 200 || data[k + 1] < 200 || data[k + 2] < 200) ++inked[k / 4 / canvas.width < canvas.height - 66 ? 0 : 1];
    return {width: canvas.width, height: canvas.height, inked};
  }, Buffer.from(bytes).toString("base64"));
  await other.close();
  assert.equal(seen.width, told.width + (told.width % 2));
  assert.ok(seen.height >= told.height + 66 && seen.height <= told.height + 67);
  assert.ok(seen.inked[0] > 500 && seen.inked[1] > 100, `${seen.inked} pixels of particles and words`);
  assert.equal(await page.textContent("#film"), "record a film");
  return found;
}
