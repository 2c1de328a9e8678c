// SPDX-License-Identifier: MIT
#include "model/base/error.h"

#include <fmt/format.h>

#include <string_view>

#include "model/base/enum_names.h"
#include "model/base/error_parts.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr std::string_view kHint = "\n  hint: ";

// A name from a file may have megabytes. Both ends of the message stay: what it is about, and what is wrong.
std::string line_of(const std::string& raw) {
  constexpr size_t kHead = 1200, kTail = 600;
  const std::string text = line_text(raw);
  if (text.size() <= kHead + kTail + 100) return text;
  const auto begins = [&](size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0) != 0x80; };
  size_t head = kHead, tail = text.size() - kTail;
  while (head > 0 && !begins(head)) --head;
  while (tail < text.size() && !begins(tail)) ++tail;
  return text.substr(0, head) + fmt::format(" ... ({} bytes more) ... ", tail - head) + text.substr(tail);
}

std::string with_hint(const std::string& message, const std::string& hint) {
  return hint.empty() ? line_of(message) : line_of(message) + std::string(kHint) + line_of(hint);
}

}  // namespace

InputError::InputError(const std::string& message, const std::string& hint)
    : std::runtime_error(with_hint(message, hint)) {}

InputError::InputError(const std::string& file, int line, int column, const std::string& message,
                       const std::string& hint, const std::string& excerpt)
    : std::runtime_error(with_hint(fmt::format("{}:{}:{}: {}", file, line, column, message), hint)),
      place_(std::make_shared<const Place>(Place{file, line, column, excerpt})) {}

InputError InputError::with(const std::string& hint) const {
  InputError other(parts_of(*this).message, hint);
  other.place_ = place_;
  other.keys_ = keys_;
  return other;
}

InputError InputError::about(std::vector<std::string> keys) const {
  InputError other = *this;
  other.keys_ = std::move(keys);
  return other;
}

std::string InputError::told() const {
  if (!place_ || place_->excerpt.empty()) return what();
  const ErrorParts parts = parts_of(*this);
  return parts.message + '\n' + place_->excerpt + (parts.hint.empty() ? "" : std::string(kHint) + parts.hint);
}

std::string InputError::json() const {
  const ErrorParts parts = parts_of(*this);
  std::string file = "null", line = "null", column = "null";
  if (place_) {
    file = json_text(place_->file);
    line = std::to_string(place_->line);
    column = std::to_string(place_->column);
  }
  return fmt::format("{{\"error\":{{\"message\":{},\"file\":{},\"line\":{},\"column\":{},\"hint\":{}}}}}",
                     json_text(bare_message(*this)), file, line, column,
                     parts.hint.empty() ? "null" : json_text(parts.hint));
}

namespace {

ErrorParts parts_of_text(const std::string& text) {
  const size_t at = text.find(kHint);
  return at == std::string::npos ? ErrorParts{text, ""}
                                 : ErrorParts{text.substr(0, at), text.substr(at + kHint.size())};
}

}  // namespace

ErrorParts parts_of(const InputError& error) { return parts_of_text(error.what()); }

InputError error_of(const std::string& text) {
  const ErrorParts parts = parts_of_text(text);
  return InputError(parts.message, parts.hint);
}

std::string bare_message(const InputError& error) {
  std::string message = parts_of(error).message;
  if (const InputError::Place* place = error.place()) {
    const std::string head = line_text(fmt::format("{}:{}:{}: ", place->file, place->line, place->column));
    if (message.starts_with(head)) message.erase(0, head.size());
  }
  return message;
}

const char* to_string(Fault fault) {
  constexpr const char* kNames[] = {"none",
                                    "relative velocity out of width",
                                    "pair strength out of width",
                                    "sum of kicks out of width",
                                    "displacement out of width",
                                    "velocity out of width",
                                    "left the lattice along x",
                                    "cell full after moving along x",
                                    "left the lattice along y",
                                    "cell full after moving along y",
                                    "left the lattice along z",
                                    "cell full after moving along z",
                                    "wrong check of a beat",
                                    "beat lost or repeated",
                                    "beats not acknowledged",
                                    "partner of a bond out of reach"};
  return name_in(kNames, fault);
}

namespace {

std::string text_of(Fault fault, uint64_t step, uint32_t cell, uint32_t particle, int64_t number,
                    const std::string& where) {
  constexpr const char* kFace[] = {"-x", "+x", "-y", "+y", "-z", "+z"};
  if (is_of_link(fault))
    return fmt::format("step {}, node of cell {}{}, link {}: {}", step, cell, where,
                       number >= 0 && number < 6 ? kFace[number] : "?", to_string(fault));
  return fmt::format("step {}, cell {}{}, particle {}: {} ({})", step, cell, where, particle,
                     to_string(fault), number);
}

}  // namespace

RunError::RunError(Fault fault, uint64_t step, uint32_t cell, uint32_t particle, int64_t number,
                   const std::string& where)
    : std::runtime_error(text_of(fault, step, cell, particle, number, where)),
      fault(fault),
      step(step),
      cell(cell),
      particle(particle),
      number(number) {}

}  // namespace cuboct
