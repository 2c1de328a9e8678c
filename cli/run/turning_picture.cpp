// SPDX-License-Identifier: MIT
#include "cli/run/turning_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cli/run/outputs.h"
#include "model/base/base64.h"
#include "model/base/json.h"
#include "model/trace/render.h"

namespace cuboct {
namespace {

constexpr size_t kMost = 10000;   // particles, spread over the ids: some 100 kB of the page
constexpr double kSteps = 65535;  // of a place along an axis
constexpr uint8_t kUnknown = 255, kMiddle = 127;

// Orthographic; particles from the back to the front, as discs that are drawn once for each colour.
constexpr char kScript[] = R"js("use strict";
const told = JSON.parse(document.getElementById("turn-data").textContent), canvas = document.getElementById("turn"), pen = canvas.getContext("2d");
const bytes = (text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
const words = new Uint16Array(bytes(told.places).buffer), values = bytes(told.values), count = values.length, size = Math.max(...told.extent, 2 * told.radius);
const place = Float32Array.from(words, (word, k) => ((word / 65535 - 0.5) * told.extent[k % 3]) / size);
const {stops} = told, reach = Math.hypot(...told.extent) / size;
const at = {yaw: 0.6, pitch: 0.5, zoom: 1}, depth = new Float32Array(count), order = Uint32Array.from(values, (_, k) => k);
let discs = [], wide = 0;
function disc(value, radius) {
  if (discs[value]) return discs[value];
  const share = value / 127 - 1, next = Math.max(1, stops.findIndex(([end]) => share <= end)), [from, ...below] = stops[next - 1], [to_end, ...above] = stops[next];
  const colour = value === 255 ? [150, 150, 150] : below.map((one, k) => Math.round(one + ((share - from) / (to_end - from)) * (above[k] - one)));
  const made = document.createElement("canvas"), side = made.width = made.height = Math.ceil(2 * radius) + 2, to = made.getContext("2d");
  to.fillStyle = `rgb(${colour})`;
  to.strokeStyle = `rgb(${colour.map((one) => Math.round(0.6 * one))})`;
  to.lineWidth = Math.min(1, radius / 4);
  to.beginPath(), to.arc(side / 2, side / 2, radius, 0, 2 * Math.PI), to.fill(), to.stroke();
  return (discs[value] = made);
}
function draw() {
  const {width, height} = canvas, scale = (0.92 * at.zoom * Math.min(width, height)) / reach, radius = Math.max(0.7, (told.radius / size) * scale);
  if (radius !== wide) discs = [], wide = radius;
  const [a, b, c, d] = [Math.cos(at.yaw), Math.sin(at.yaw), Math.cos(at.pitch), Math.sin(at.pitch)];
  for (let k = 0; k < count; ++k) depth[k] = (b * place[3 * k] + a * place[3 * k + 1]) * c - place[3 * k + 2] * d;
  order.sort((one, other) => depth[other] - depth[one]);
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, width, height);
  for (const k of order) {
    const x = a * place[3 * k] - b * place[3 * k + 1], y = place[3 * k + 2] * c + (b * place[3 * k] + a * place[3 * k + 1]) * d;
    const made = disc(values[k], radius);
    pen.drawImage(made, width / 2 + x * scale - made.width / 2, height / 2 - y * scale - made.height / 2);
  }
}
canvas.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  at.yaw += 0.01 * event.movementX;
  at.pitch = Math.max(-1.57, Math.min(1.57, at.pitch + 0.01 * event.movementY));
  requestAnimationFrame(draw);
});
canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  at.zoom = Math.max(0.3, Math.min(20, at.zoom * Math.exp(-0.001 * event.deltaY)));
  requestAnimationFrame(draw);
}, {passive: false});
document.getElementById("turn-part").hidden = false;
draw();
)js";

double usual(const std::vector<double>& strain) {
  std::vector<double> sizes;
  for (const double one : strain)
    if (std::isfinite(one)) sizes.push_back(std::abs(one));
  if (sizes.empty()) return 0;
  const auto at = sizes.begin() + static_cast<ptrdiff_t>(sizes.size() * 9 / 10);
  std::nth_element(sizes.begin(), at, sizes.end());
  return *at;
}

std::string anchor_json(const Anchor& one) {
  const auto channel = [&](size_t k) { return static_cast<double>(one.colour[k]); };
  return json(std::vector<double>{one.at, channel(0), channel(1), channel(2)});
}

std::string vector_json(const Vec3& v) { return json(std::vector<double>{v[0], v[1], v[2]}); }

}  // namespace

// tests/view/report_page_test.mjs runs it under this policy.
std::string turning_script_hash() { return "'sha256-s8f5LdZLUMO3JuDUZGUctsPnGlps2Ri4yYWBUb1jjo8='"; }

std::string turning_picture(const Scene& scene, const Frame& frame, std::optional<double> limit) {
  const size_t all = frame.x.size(), shown = std::min(all, kMost);
  const double end = limit ? *limit : usual(frame.strain);
  Vec3 lower = Vec3::Constant(INFINITY), upper = -lower;
  std::vector<size_t> ids;
  for (size_t k = 0; k < shown; ++k) {
    const size_t id = k * all / shown;
    if (!frame.x[id].allFinite()) continue;
    ids.push_back(id);
    lower = lower.cwiseMin(frame.x[id]), upper = upper.cwiseMax(frame.x[id]);
  }
  if (ids.empty()) return "";
  std::string places, values;
  for (const size_t id : ids) {
    for (int a = 0; a < 3; ++a) {
      const double extent = upper[a] - lower[a];
      const auto word =
          static_cast<uint16_t>(extent > 0 ? std::lround((frame.x[id][a] - lower[a]) / extent * kSteps) : 0);
      places += {static_cast<char>(word & 255), static_cast<char>(word >> 8)};
    }
    uint8_t value = kUnknown;
    if (id < frame.strain.size() && std::isfinite(frame.strain[id]))
      value = end > 0 ? static_cast<uint8_t>(
                            std::lround(kMiddle * (1 + std::clamp(frame.strain[id] / end, -1.0, 1.0))))
                      : kMiddle;
    values += static_cast<char>(value);
  }
  // Of a part each stands for more: the body stays closed.
  const double radius =
      frame_style(scene).radius * std::cbrt(static_cast<double>(all) / static_cast<double>(shown));
  const std::string data = json_object({{"places", json(base64(places.data(), places.size()))},
                                        {"values", json(base64(values.data(), values.size()))},
                                        {"extent", vector_json(upper - lower)},
                                        {"radius", json(radius)},
                                        {"stops", json_array(kDiverging, anchor_json)}});
  return fmt::format(
      "<figure class=\"wide\" id=\"turn-part\" hidden><canvas id=\"turn\" width=\"720\" height=\"480\" "
      "aria-label=\"The particles of the last picture\"></canvas>\n<figcaption class=\"note\">The last "
      "picture{}, coloured from {:.3g} to {:.3g} of axial strain: drag turns it, the wheel "
      "zooms.</figcaption></figure>\n"
      "<script type=\"application/json\" id=\"turn-data\">{}</script>\n<script>{}</script>\n",
      shown < all ? fmt::format(", {} of {} particles", shown, all) : "", -end, end, data, kScript);
}

}  // namespace cuboct
