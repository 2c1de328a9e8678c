// SPDX-License-Identifier: MIT
// A WebM file of encoded pictures: one video track, a cluster for each key picture. RFC 8794 has EBML, RFC 9559 the elements.

const kHead = new TextEncoder();
const kWriter = kHead.encode("cuboct");

function bytes_of(value, count) {
  return Uint8Array.from({length: count}, (_, k) => Math.floor(value / 2 ** (8 * (count - 1 - k))) % 256);
}
const whole = (value) => bytes_of(value, value < 2 ** 32 ? 4 : 8);
function double(value) {
  const out = new DataView(new ArrayBuffer(8));
  out.setFloat64(0, value);
  return new Uint8Array(out.buffer);
}

// An element: its number, its size in eight bytes, and what it holds.
function element(id, ...parts) {
  const numbers = bytes_of(id, id > 0xffffff ? 4 : id > 0xffff ? 3 : id > 0xff ? 2 : 1);
  const all = parts.flat(Infinity), size = all.reduce((sum, part) => sum + part.length, 0);
  return [numbers, Uint8Array.of(0x01, ...bytes_of(size, 7)), ...all];
}

// `pictures`: {key, data} in their order, so many a second. `codec`: "V_VP8" or "V_VP9".
export function webm_of(pictures, {codec, width, height, rate}) {
  const ms = (k) => Math.round((1000 * k) / rate), text = (words) => kHead.encode(words);
  const head = element(0x1a45dfa3, element(0x4286, whole(1)), element(0x42f7, whole(1)), element(0x42f2, whole(4)), element(0x42f3, whole(8)),
    element(0x4282, text("webm")), element(0x4287, whole(4)), element(0x4285, whole(2)));
  const info = element(0x1549a966, element(0x2ad7b1, whole(1e6)), element(0x4489, double(ms(pictures.length))), element(0x4d80, kWriter), element(0x5741, kWriter));
  const track = element(0x1654ae6b, element(0xae, element(0xd7, whole(1)), element(0x73c5, whole(1)), element(0x83, whole(1)), element(0x86, text(codec)),
    element(0x23e383, whole(Math.round(1e9 / rate))), element(0xe0, element(0xb0, whole(width)), element(0xba, whole(height)))));
  const clusters = [];
  let begin = 0, blocks = [];
  const end = () => { if (blocks.length) clusters.push(element(0x1f43b675, element(0xe7, whole(ms(begin))), blocks)); };
  pictures.forEach(({key, data}, k) => {
    if (key) end(), blocks = [], begin = k;
    blocks.push(element(0xa3, Uint8Array.of(0x81, ...bytes_of(ms(k) - ms(begin), 2), key ? 0x80 : 0), data));
  });
  end();
  return new Blob([head, element(0x18538067, info, track, clusters)].flat(Infinity), {type: "video/webm"});
}
