// SPDX-License-Identifier: MIT
#include "cli/view/saved_page.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <stdexcept>

#include "cli/view/web.h"
#include "model/base/base64.h"
#include "model/base/error.h"
#include "model/base/filled_frame.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// Bytes of equal weight together: the high ones of neighbours are alike, and so pack well.
std::string parted(const std::string& bytes, size_t width) {
  const size_t count = bytes.size() / width;
  std::string out(bytes.size(), '\0');
  for (size_t part = 0; part < width; ++part)
    for (size_t k = 0; k < count; ++k) out[part * count + k] = bytes[k * width + part];
  return out;
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw std::runtime_error("zlib cannot pack a frame");
  out.resize(size);
  return out;
}

// Of a CSP: what the page may ask for.
std::string page(const std::string& title, const std::string& story, const std::string& blocks,
                 const char* connect) {
  return filled_frame(web_page(), {{"@connect@", connect},
                                   {"@title@", html_text(title)},
                                   {"@style@", std::string(web_style())},
                                   {"@title@", html_text(title)},
                                   {"@licences@", html_text(std::string(web_licences()))},
                                   {"@blocks@", blocks},
                                   {"@story@", story},
                                   {"@script@", std::string(web_script())}});
}

// With one digit that is not 0, rounded up, so that the hint holds.
size_t rounded_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(std::max(value, 1.0))));
  return static_cast<size_t>(std::ceil(value / power) * power);
}

[[noreturn]] void refuse_size(const StoredRun& run, double bytes, size_t limit) {
  const double times = bytes / static_cast<double>(limit), mega = 1e-6 * bytes;
  throw InputError(
      fmt::format(
          "the page would take some {:.3g} MB, above the {:.3g} MB of --limit: {} frames of {} particles",
          mega, 1e-6 * static_cast<double>(limit), run.frames(), run.form().shown()),
      fmt::format(
          "--every {} keeps a part of the frames, --particles {} a part of each, --limit {} takes all",
          rounded_up(times), static_cast<size_t>(static_cast<double>(run.form().shown()) / times * 0.9),
          rounded_up(1.1 * mega)));
}

}  // namespace

bool has_view_page() { return true; }

std::string saved_page(const StoredRun& run, size_t limit) {
  Story story = run.tell();
  std::string blocks;
  for (size_t k = 0; k < run.frames(); ++k) {
    const ViewFrame frame = run.frame(k);
    story.frames.push_back(frame.json());
    for (size_t b = 0; b < frame.blocks.size(); ++b) {
      const std::string bytes = packed(parted(frame.blocks[b], run.form().blocks()[b].width()));
      blocks += fmt::format("<script type=\"text/plain\" id=\"b{}-{}\">{}</script>\n", k, b,
                            base64(bytes.data(), bytes.size()));
    }
    const double whole =
        static_cast<double>(blocks.size()) / static_cast<double>(k + 1) * static_cast<double>(run.frames());
    if (blocks.size() > limit) refuse_size(run, whole, limit);
  }
  const std::string html = page(run.title(), story.json(), blocks, "'none'");
  if (html.size() > limit) refuse_size(run, static_cast<double>(html.size()), limit);
  return html;
}

std::string served_page() { return page("cuboct view", "{\"served\":true}", "", "'self'"); }

}  // namespace cuboct
