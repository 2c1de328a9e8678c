// SPDX-License-Identifier: MIT
// Frames come in blocks: places, types, exact numbers, one field each. The head's `blocks` says what each holds (model/trace/view_blocks.h).

const kArrays = {u8: Uint8Array, u16: Uint16Array, u32: Uint32Array, f32: Float32Array, f64: Float64Array, words: Uint8Array};
export const kWidths = {u8: 1, u16: 2, u32: 4, f32: 4, f64: 8, words: 8};

export function array_of(form, buffer) {
  return new kArrays[form.number](buffer);
}

// Bytes of equal weight stand together in a saved page, as they pack better so.
function joined(bytes, width) {
  if (width === 1) return bytes;
  const count = bytes.length / width, out = new Uint8Array(bytes.length);
  for (let part = 0; part < width; ++part)
    for (let k = 0; k < count; ++k) out[k * width + part] = bytes[part * count + k];
  return out;
}

async function unpacked(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function bytes_in(id) {
  const packed = atob(document.getElementById(id).textContent.trim()), bytes = new Uint8Array(packed.length);
  for (let k = 0; k < packed.length; ++k) bytes[k] = packed.charCodeAt(k);
  return bytes;
}

// What stands in the page itself.
export class SavedFrames {
  // `prefix`: of its elements; "w-" of the run that is compared with.
  constructor(story, prefix = "") {
    this.story = story;
    this.prefix = prefix;
    this.live = false;
  }
  async block(frame, index) {
    const form = this.story.head.blocks[index];
    return joined(await unpacked(bytes_in(`${this.prefix}b${frame}-${index}`)), kWidths[form.number]).buffer;
  }
  // Words of the machine: "nodes" 0, "held" of a frame, "spans" of a step.
  async machine(name, k) {
    return joined(await unpacked(bytes_in(`m-${name}-${k}`)), 4).buffer;
  }
  // The numbers of one particle.
  async row(frame, index, place) {
    const form = this.story.head.blocks[index], size = form.numbers * kWidths[form.number];
    return (await this.block(frame, index)).slice(place * size, (place + 1) * size);
  }
}

// What a server holds: its address ends in the token, and all that is asked lies below it.
export class ServedFrames {
  // `prefix`: of its paths; "with/" of the run that is compared with.
  constructor(story, prefix = "") {
    this.story = story;
    this.prefix = prefix;
    this.live = story.live;
  }
  async ask(path) {
    const answer = await fetch(this.prefix + path, {cache: "no-store"});
    if (!answer.ok) throw Object.assign(new Error(`${path}: ${answer.status} ${await answer.text()}`), {status: answer.status});
    return answer;
  }
  async block(frame, index) {
    return (await this.ask(`frame/${frame}/${index}`)).arrayBuffer();
  }
  async machine(name, k) {
    return (await this.ask(`machine/${name}/${k}`)).arrayBuffer();
  }
  async row(frame, index, place) {
    return (await this.ask(`frame/${frame}/${index}?row=${place}`)).arrayBuffer();
  }
  async news(frames, lines) {
    return (await this.ask(`news?frames=${frames}&lines=${lines}`)).json();
  }
  // Why not; empty: it is taken.
  async steer(words) {
    const answer = await fetch("steer/" + words.join("/"), {method: "POST", cache: "no-store"});
    return answer.status === 204 ? "" : (await answer.text()) || `refused (${answer.status})`;
  }
  async command(word) {
    return fetch("command/" + word, {method: "POST", cache: "no-store"});
  }
}
