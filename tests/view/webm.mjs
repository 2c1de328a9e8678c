// SPDX-License-Identifier: MIT
// The pictures of a WebM file: https://www.matroska.org/technical/elements.html has the numbers.
import assert from "node:assert/strict";

const kHeader = 0x1a45dfa3, kDocType = 0x4282, kSegment = 0x18538067, kTracks = 0x1654ae6b, kTrack = 0xae, kVideo = 0xe0, kWidth = 0xb0,
  kHeight = 0xba, kCluster = 0x1f43b675, kTime = 0xe7, kGroup = 0xa0, kBlock = 0xa1, kSimple = 0xa3, kInfo = 0x1549a966, kDuration = 0x4489;
const kParents = new Set([kHeader, kSegment, kInfo, kTracks, kTrack, kVideo, kCluster, kGroup]);

// {width, height, duration: ms, times: ms of each picture}
export function read_webm(bytes) {
  assert.equal(bytes.readUInt32BE(0), kHeader, "a film begins with EBML");
  const found = {times: []};
  let cluster = 0, at = 0;
  // A number whose length its leading zeros tell; as a size all ones mean unknown.
  const number = (marked) => {
    const length = Math.clz32(bytes[at]) - 23;
    assert.ok(length >= 1 && length <= 8);
    let value = marked ? bytes[at] : bytes[at] & (0xff >> length), ones = (bytes[at] & (0xff >> length)) === 0xff >> length;
    for (let k = 1; k < length; ++k) value = value * 256 + bytes[at + k], ones &&= bytes[at + k] === 0xff;
    at += length;
    return !marked && ones ? Infinity : value;
  };
  const whole = (from, size) => [...bytes.subarray(from, from + size)].reduce((sum, byte) => 256 * sum + byte, 0);
  while (at < bytes.length) {
    const id = number(true), size = number(false);
    if (kParents.has(id)) continue;
    assert.ok(at + size <= bytes.length, "no element is cut");
    if (id === kDocType) assert.equal(bytes.toString("latin1", at, at + size), "webm");
    if (id === kDuration) found.duration = bytes.readDoubleBE(at);
    if (id === kWidth) found.width = whole(at, size);
    if (id === kHeight) found.height = whole(at, size);
    if (id === kTime) cluster = whole(at, size);
    if (id === kSimple || id === kBlock) found.times.push(cluster + bytes.readInt16BE(at + 1));  // behind the track's number
    at += size;
  }
  return found;
}
