// SPDX-License-Identifier: MIT
// What is seen, with its frame, time and colours in words, as one picture; and pictures after one another as a film.
import {by_id} from "./format.js";

const kRate = 15;      // pictures a second
const kBits = 8e6;     // of the film, a second
const kLine = 22;      // CSS pixels of a line of text
const kKinds = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

// Draws the pictures side by side, and below them what the page says of them.
export function compose(canvas, page) {
  const stages = page.stages(), scale = stages[0].renderer.getPixelRatio();
  const widths = stages.map(({renderer}) => renderer.domElement.width), high = stages[0].renderer.domElement.height;
  const list = by_id("types").hidden ? [] : [...by_id("types").children].map((entry) => [entry.textContent, entry.querySelector(".dot").style.background]);
  const wide = widths.reduce((sum, width) => sum + width, 0), below = 3 * kLine * scale;
  // Films are of even sizes.
  canvas.width = wide + (wide % 2), canvas.height = high + below + ((high + below) % 2);
  const pen = canvas.getContext("2d");
  pen.fillStyle = "#ffffff", pen.fillRect(0, 0, canvas.width, canvas.height);
  let left = 0;
  stages.forEach((stage, k) => {
    stage.draw_now();  // what a canvas of WebGL holds is gone once it was shown
    pen.drawImage(stage.renderer.domElement, left, 0);
    left += widths[k];
  });
  pen.fillStyle = "#222222", pen.font = `${14 * scale}px system-ui, sans-serif`, pen.textBaseline = "middle";
  const line = (k) => high + (k + 0.5) * kLine * scale, indent = 10 * scale;
  const captions = [by_id("caption"), by_id("caption-beside")].filter((one) => !one.hidden).map((one) => one.textContent).join("    ");
  pen.fillText([by_id("title").textContent, captions].filter(Boolean).join(":  "), indent, line(0), canvas.width - 2 * indent);
  pen.fillText(page.told(), indent, line(1), canvas.width - 2 * indent);
  if (list.length > 0) {
    let at = indent;
    const room = (canvas.width - 2 * indent) / list.length;
    for (const [text, colour] of list) {
      pen.fillStyle = colour, pen.fillRect(at, line(2) - 5 * scale, 10 * scale, 10 * scale);
      pen.fillStyle = "#222222", pen.fillText(text, at + 14 * scale, line(2), room - 20 * scale);
      at += Math.min(room, 24 * scale + pen.measureText(text).width);
    }
  } else {
    const words = `${by_id("legend-name").textContent}: ${by_id("legend-low").textContent}`, bar = 160 * scale, from = indent + pen.measureText(words).width + 8 * scale;
    pen.fillText(words, indent, line(2));
    const ramp = pen.createLinearGradient(from, 0, from + bar, 0);
    page.stops.forEach((colour, k) => ramp.addColorStop(k / (page.stops.length - 1), colour));
    pen.fillStyle = ramp, pen.fillRect(from, line(2) - 5 * scale, bar, 10 * scale);
    pen.fillStyle = "#222222", pen.fillText(by_id("legend-high").textContent, from + bar + 8 * scale, line(2));
  }
}

export const still = (page) => {
  const canvas = document.createElement("canvas");
  compose(canvas, page);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
};

// The kind of film that this browser makes; nothing: none.
export const kind_of_film = () => (globalThis.MediaRecorder ? kKinds.find((kind) => MediaRecorder.isTypeSupported(kind)) : undefined);

// Films what `pictures` steps through: each call of it shows the next picture and answers whether there was one. A blob.
export async function film(page, pictures, goes_on) {
  const canvas = document.createElement("canvas"), parts = [];
  compose(canvas, page);
  const {width, height} = canvas, stream = canvas.captureStream(0), [track] = stream.getVideoTracks();
  const recorder = new MediaRecorder(stream, {mimeType: kind_of_film(), videoBitsPerSecond: kBits});
  recorder.addEventListener("dataavailable", ({data}) => parts.push(data));
  const over = new Promise((done, fail) => {
    recorder.addEventListener("stop", done);
    recorder.addEventListener("error", ({error}) => fail(error || new Error("the film cannot be recorded")));
  });
  recorder.start(1000);
  let count = 0;
  for (let next = performance.now(); goes_on() && (await pictures());) {
    compose(canvas, page);
    if (canvas.width !== width || canvas.height !== height) throw new Error("the film has ended: the picture's size has changed");
    track.requestFrame();
    ++count;
    next = Math.max(next + 1000 / kRate, performance.now());  // a picture that takes longer stays longer
    await new Promise((done) => setTimeout(done, next - performance.now()));
  }
  await new Promise((done) => setTimeout(done, 2000 / kRate));  // the last is seen, too
  recorder.stop();
  await over;
  track.stop();
  return {blob: new Blob(parts, {type: "video/webm"}), count};
}
