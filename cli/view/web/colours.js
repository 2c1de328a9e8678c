// SPDX-License-Identifier: MIT
// Colours of values: of numbers with a sign a scale that parts at zero, of others viridis (van der Walt and Smith 2015), of types
// a colour each.

const kViridis = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];
const kDiverging = ["#1c3d7a", "#2166ac", "#4393c3", "#92c5de", "#dcdcdc", "#f4a582", "#d6604d", "#b2182b", "#72101f"];
// Okabe and Ito's, which people tell apart whatever they see of colours.
export const kTypes = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#999999"];

const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

// 256 colours, four bytes each.
export function table_of(kind) {
  const stops = (kind === "diverging" ? kDiverging : kViridis).map(channels);
  const table = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; ++k) {
    const at = (k / 255) * (stops.length - 1), left = Math.min(Math.floor(at), stops.length - 2), part = at - left;
    for (let c = 0; c < 3; ++c) table[4 * k + c] = Math.round(stops[left][c] * (1 - part) + stops[left + 1][c] * part);
    table[4 * k + 3] = 255;
  }
  return table;
}

export function table_of_types(count) {
  const table = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; ++k) {
    const type = Math.min(Math.floor((k * count) / 256), count - 1);
    table.set([...channels(kTypes[type % kTypes.length]), 255], 4 * k);
  }
  return table;
}

export function gradient_of(kind) {
  const stops = kind === "diverging" ? kDiverging : kViridis;
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

// Between which the middle 98 of 100 values are: few that flew off would else take all colours. Of values with a sign it is even
// about zero. A sample of 20,000 tells it.
export function range_of(values) {
  const stride = Math.max(1, Math.floor(values.length / 20000)), some = [];
  for (let k = 0; k < values.length; k += stride) if (Number.isFinite(values[k])) some.push(values[k]);
  if (some.length === 0) return {low: 0, high: 1, signed: false, empty: true};
  some.sort((a, b) => a - b);
  const at = (share) => some[Math.min(some.length - 1, Math.floor(share * some.length))];
  let low = at(0.01), high = at(0.99);
  if (low === high) low = some[0], high = some[some.length - 1];
  const signed = low < 0;
  if (signed) high = Math.max(-low, high), low = -high;
  if (low === high) high = low === 0 ? 1 : low + Math.abs(low) * 1e-6;
  return {low, high, signed, empty: false};
}
