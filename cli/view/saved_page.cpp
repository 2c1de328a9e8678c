// SPDX-License-Identifier: MIT
#include "cli/view/saved_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "cli/view/web.h"
#include "model/base/base64.h"
#include "model/base/error.h"
#include "model/base/filled_frame.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

// Phases of all steps take this part of the page at most; blocks of the machine are words of so many bytes.
constexpr size_t kMachinePart = 10, kMachineWidth = 4;

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

std::string element(const std::string& id, const std::string& block, size_t width) {
  const std::string bytes = packed(parted(block, width));
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id,
                     base64(bytes.data(), bytes.size()));
}

// What a page shows: a run and its machine, or two runs.
struct Shown {
  const StoredRun& run;
  const ComparedRuns* compared = nullptr;

  bool has_machine() const { return compared == nullptr && run.machine().is_there(); }

  // The elements of frame k; entries of it are added to the stories.
  std::string frame(size_t k, Story& story, Story& second) const {
    std::string blocks = frame_of(run, k, "", story);
    if (compared != nullptr) blocks += frame_of(compared->second(), k, "w-", second);
    if (has_machine()) blocks += element(fmt::format("m-held-{}", k), run.held(k), kMachineWidth);
    return blocks;
  }
  // Bytes of frame k, with its entries.
  size_t bytes(size_t k) const {
    Story story = run.tell(), second = story;
    const size_t blocks = frame(k, story, second).size();
    return blocks + story.frames[0].size() + (second.frames.empty() ? 0 : second.frames[0].size());
  }
  // Bytes of a frame's particles before they are packed, each; and of what else it has.
  std::pair<size_t, size_t> row_and_rest() const {
    size_t row = 0, rest = has_machine() ? kElement + run.held(0).size() : 0;
    for (const StoredRun* one : {&run, compared != nullptr ? &compared->second() : nullptr})
      for (size_t b = 0; one != nullptr && b < one->form().blocks().size(); ++b)
        row += one->form().blocks()[b].row(), rest += kElement;
    return {row, rest + 200};
  }

 private:
  static constexpr size_t kElement = 100;  // bytes beside those of the particles
  static std::string frame_of(const StoredRun& run, size_t k, const char* prefix, Story& story) {
    const ViewFrame frame = run.frame(k);
    story.frames.push_back(frame.json());
    std::string blocks;
    for (size_t b = 0; b < frame.blocks.size(); ++b)
      blocks +=
          element(fmt::format("{}b{}-{}", prefix, k, b), frame.blocks[b], run.form().blocks()[b].width());
    return blocks;
  }
};

// The steps whose phases the page has: all where they take a small part of it, else those of frames. Nothing:
// all.
std::optional<std::vector<size_t>> kept_steps(const StoredRun& run, size_t limit) {
  if (run.machine().steps() * run.machine().step_bytes() <= limit / kMachinePart) return std::nullopt;
  return run.steps_of_frames();
}

// The elements of the machine but for those of frames.
std::string machine_blocks(const StoredRun& run, const std::optional<std::vector<size_t>>& kept) {
  const ViewMachine& machine = run.machine();
  if (!machine.is_there()) return {};
  std::string blocks = element("m-nodes-0", machine.nodes(), kMachineWidth);
  const size_t count = kept ? kept->size() : machine.steps();
  for (size_t k = 0; k < count; ++k) {
    const size_t step = kept ? (*kept)[k] : k;
    blocks += element(fmt::format("m-spans-{}", step), machine.spans(step), kMachineWidth);
  }
  return blocks;
}

// `fixed`: bytes of the page without frames; `most`: of the largest frame so far.
[[noreturn]] void refuse_size(const Shown& shown, size_t fixed, size_t most, size_t limit, size_t every) {
  const size_t frames = shown.run.frames();
  // Frames of a body that moves pack worse than the first.
  for (const size_t k : {frames / 2, frames - 1}) most = std::max(most, shown.bytes(k));
  const double each = 1.1 * static_cast<double>(most);
  const double bytes = static_cast<double>(fixed) + static_cast<double>(frames) * each;
  const double room = static_cast<double>(limit) - static_cast<double>(fixed);
  std::vector<std::string> hints;
  // Each n-th of the frames, and the last: frames / n + 2 at most.
  if (room / each >= 3)
    hints.push_back(
        fmt::format("--every {} keeps a part of the frames",
                    every * rounded_up(static_cast<double>(frames) / (std::floor(room / each) - 2))));
  // A part of the particles packs worse than all: as if it did not pack at all.
  const auto [row, rest] = shown.row_and_rest();
  const double part =
      (room / static_cast<double>(frames) - static_cast<double>(rest)) / (1.4 * static_cast<double>(row));
  if (part >= 1) hints.push_back(fmt::format("--particles {} a part of each", static_cast<size_t>(part)));
  if (const size_t mega = rounded_up(1e-6 * bytes); mega <= kMostMegabytes)
    hints.push_back(fmt::format("--limit {} takes all", mega));
  if (hints.empty()) hints.emplace_back("--every and --particles together keep less");
  throw InputError(
      fmt::format(
          "the page would take some {:.3g} MB, above the {:.3g} MB of --limit: {} frames of {} particles",
          1e-6 * bytes, 1e-6 * static_cast<double>(limit), frames, shown.run.form().shown()),
      fmt::format("{}", fmt::join(hints, ", ")));
}

std::string saved(const Shown& shown, size_t limit, size_t every) {
  const StoredRun& run = shown.run;
  Story story = run.tell(), second = shown.compared ? shown.compared->second().tell() : Story{};
  std::string blocks;
  if (shown.compared == nullptr) {
    const std::optional<std::vector<size_t>> kept = kept_steps(run, limit);
    story.machine = run.machine().json(kept);
    blocks = machine_blocks(run, kept);
  }
  const auto whole = [&] {
    if (shown.compared != nullptr) story.with = shown.compared->with(second);
    return page(run.title(), story.json(), blocks, "'none'");
  };
  const size_t fixed = whole().size();
  size_t most = 0;
  for (size_t k = 0; k < run.frames(); ++k) {
    const std::string added = shown.frame(k, story, second);
    most = std::max(most, added.size() + story.frames.back().size());
    blocks += added;
    if (blocks.size() > limit) refuse_size(shown, fixed, most, limit, every);
  }
  std::string html = whole();
  if (html.size() <= limit) return html;
  if (run.frames() > 0) refuse_size(shown, fixed, most, limit, every);
  throw InputError(fmt::format("the page takes {:.3g} MB without any frame, above the {:.3g} MB of --limit",
                               1e-6 * static_cast<double>(html.size()), 1e-6 * static_cast<double>(limit)),
                   "a larger --limit");
}

}  // namespace

bool has_view_page() { return true; }

std::string saved_page(const StoredRun& run, size_t limit, size_t every) {
  return saved({run}, limit, every);
}

std::string saved_page(const ComparedRuns& runs, size_t limit, size_t every) {
  return saved({runs.first(), &runs}, limit, every);
}

std::string served_page() { return page("cuboct view", "{\"served\":true}", "", "'self'"); }

}  // namespace cuboct
