// SPDX-License-Identifier: MIT
// Numbers as people read them, and elements of the page. Text enters the page as text alone.

export function element(name, text, kind) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

// Hands a file to the reader.
export function save(blob, name) {
  const link = element("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export const by_id = (id) => document.getElementById(id);

// As many significant digits as asked for; "–" where there is no number.
export function number(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e6 ? String(Number(value.toPrecision(digits))) : value.toExponential(digits - 1);
}

export const with_unit = (value, unit, digits) => number(value, digits) + (unit && unit !== "1" ? " " + unit : "");

// Of the ticks of an axis from `low` to `high`: some three to seven round numbers.
export function ticks(low, high) {
  const span = high - low;
  if (!(span > 0) || !Number.isFinite(span)) return [low];
  const power = 10 ** Math.floor(Math.log10(span / 4));
  const step = [1, 2, 5, 10].map((k) => k * power).find((size) => span / size <= 6);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12); ++k) found.push(k * step);
  return found;
}
