// SPDX-License-Identifier: MIT
// One particle's exact numbers. Of the fixed rule they are words: the cell, the offset in it and the velocity, as
// docs/reference/trace.md has them. A run in real numbers has doubles.

const kAxes = [0, 1, 2];

// Two's complement in so many bits, in groups of four from the right.
export function bits_of(word, bits) {
  const text = BigInt.asUintN(bits, word).toString(2).padStart(bits, "0");
  return text.replace(/\B(?=(....)+$)/g, " ");
}

// {x, v} in SI, and of the fixed rule {cell, words, bits}.
export function exact_of(head, buffer) {
  const view = new DataView(buffer);
  if (head.blocks[head.exact].number === "f64")
    return {x: kAxes.map((k) => view.getFloat64(8 * k, true)), v: kAxes.map((k) => view.getFloat64(24 + 8 * k, true))};
  // In the order of model/contract/state.cpp, so that doubles are the same too.
  const {edge, origin, fraction, velocity_bits} = head.words, unit = edge.map((length) => length * 2 ** -fraction);
  const x = kAxes.map((k) => view.getBigInt64(8 * k, true)), v = kAxes.map((k) => view.getBigInt64(24 + 8 * k, true));
  const cell = kAxes.map((k) => view.getInt32(48 + 4 * k, true));
  return {
    x: kAxes.map((k) => origin[k] + cell[k] * edge[k] + Number(x[k]) * unit[k]),
    v: kAxes.map((k) => (Number(v[k]) * unit[k]) / head.dt),
    cell, words: {x, v},
    bits: {x: x.map((word) => bits_of(word, fraction)), v: v.map((word) => bits_of(word, velocity_bits))},
  };
}
