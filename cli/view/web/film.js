// SPDX-License-Identifier: MIT
// A film of what the page plays, as WebM: picture after picture is drawn and encoded by the browser. The film's clock is its own: pictures
// stand equally long, however long they take to draw.
import {by_id, save, with_unit} from "./format.js";
import {webm_of} from "./webm.js";

const kCodecs = [["vp8", "V_VP8"], ["vp09.00.40.08", "V_VP9"]];  // VP8 takes the least time
const kBits = 0.4;       // of a pixel of each picture
const kKeyEvery = 60;    // pictures
const kWaiting = 4;      // pictures that may wait for the encoder
const kStrip = 0.05;     // of the width, below the pictures, for words

const even = (length) => 2 * Math.max(1, Math.round(length / 2));

// Pictures of a canvas, encoded as they come.
class Encoded {
  static async of(canvas, rate) {
    const {width, height} = canvas, rest = {width, height, framerate: rate, bitrate: Math.round(kBits * rate * width * height)};
    for (const [codec, name] of globalThis.VideoEncoder ? kCodecs : [])
      if ((await VideoEncoder.isConfigSupported({codec, ...rest})).supported) return new Encoded(canvas, rate, name, {codec, ...rest});
    throw new Error("this browser encodes no films as WebM");
  }
  constructor(canvas, rate, name, config) {
    Object.assign(this, {canvas, rate, name, pictures: [], count: 0});
    this.encoder = new VideoEncoder({
      output: (chunk) => {
        const data = new Uint8Array(chunk.byteLength);
        chunk.copyTo(data);
        this.pictures.push({key: chunk.type === "key", data});
      },
      error: (problem) => { this.problem = problem; },
    });
    this.encoder.configure(config);
  }
  async add() {
    const apart = 1e6 / this.rate, picture = new VideoFrame(this.canvas, {timestamp: Math.round(this.count * apart), duration: Math.round(apart)});
    this.encoder.encode(picture, {keyFrame: this.count++ % kKeyEvery === 0});
    picture.close();
    // The page answers meanwhile.
    do await new Promise((done) => setTimeout(done)); while (!this.problem && this.encoder.encodeQueueSize > kWaiting);
    if (this.problem) throw this.problem;
  }
  async end() {
    await this.encoder.flush();
    this.encoder.close();
    const {width, height} = this.canvas;
    return webm_of(this.pictures, {codec: this.name, width, height, rate: this.rate});
  }
}

export class Film {
  constructor(page) {
    this.page = page;
    by_id("film").addEventListener("click", () => page.attempt(() => (this.films ? this.end() : this.record(Number(by_id("film-rate").value)))));
  }
  end() { this.films = false; }

  // What is played from here on, or from the start where it is at its end: the cycles of a step, or frames.
  *pictures() {
    const {page} = this, {machine} = page;
    if (machine?.plays_cycles()) {
      for (const cycle of machine.cycles_to_play()) yield () => machine.show_cycle(cycle);
      return;
    }
    const last = page.story.frames.length - 1;
    for (let frame = page.frame < last ? page.frame : 0; frame <= last; ++frame) yield () => page.show(frame);
  }

  async record(rate) {
    const sources = this.page.stages().map((stage) => stage.renderer.domElement), canvas = document.createElement("canvas");
    this.sizes = sources.map(({width, height}) => [width, height]);
    this.strip = Math.ceil(kStrip * Math.max(320, sources[0].width));
    canvas.width = even(sources.reduce((sum, one) => sum + one.width, 0));
    canvas.height = even(Math.max(...sources.map((one) => one.height)) + this.strip);
    this.pen = canvas.getContext("2d", {alpha: false});
    this.films = true;
    by_id("film").textContent = "end the film";
    try {
      const film = await Encoded.of(canvas, rate);
      for (const show of this.pictures()) {
        await show();
        this.draw(canvas);
        await film.add();
        this.tell(canvas, film.count, rate);
        if (!this.films) break;
      }
      const blob = await film.end();
      this.tell(canvas, film.count, rate, `, ${with_unit(1e-6 * blob.size, "MB", 3)}`);
      this.made = {rate, width: canvas.width, height: canvas.height};
      save(blob, "film.webm");
    } finally {
      this.films = false;
      by_id("film").textContent = "record a film";
    }
  }
  tell({width, height}, count, rate, more = "") {
    by_id("film-told").textContent = `${count} pictures of ${width} × ${height}, ${rate} a second${more}`;
  }

  // The pictures side by side, and what they show in words. What a picture has drawn lasts as long as this call.
  draw({width, height}) {
    const {pen, page, strip} = this;
    pen.fillStyle = "#ffffff";
    pen.fillRect(0, 0, width, height);
    let left = 0;
    page.stages().forEach((stage, k) => {
      stage.draw_whole();
      pen.drawImage(stage.renderer.domElement, left, 0, ...this.sizes[k]);
      left += this.sizes[k][0];
    });
    const size = Math.round(0.42 * strip), words = [page.story.head.title, this.now(), this.legend()].filter(Boolean).join("    ");
    pen.fillStyle = "#222222";
    pen.font = `${size}px system-ui, sans-serif`;
    pen.textBaseline = "middle";
    pen.fillText(words, size, height - strip / 2, width - 2 * size);
  }
  now() {
    return this.page.machine?.plays_cycles() ? `${by_id("step-now").textContent}, ${by_id("cycle-now").textContent}` : by_id("now").textContent;
  }
  legend() {
    const text = (id) => by_id(id).textContent;
    return by_id("legend").hidden ? "" : `${text("legend-name")}: ${text("legend-low")} to ${text("legend-high")}`;
  }
}
