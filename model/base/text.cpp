// SPDX-License-Identifier: MIT
#include "model/base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "model/base/error.h"
#include "model/base/hash.h"
#include "model/base/utf8.h"

namespace cuboct {
namespace {

// A code point and its bytes; of a byte that begins none, that byte alone.
struct Symbol {
  uint32_t code = 0;
  std::string_view bytes;
  bool valid = true;
};

Symbol symbol_at(std::string_view text, size_t at) {
  const auto byte = [&](size_t k) {
    return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0U;
  };
  const uint32_t first = byte(0);
  if (first < 0x80) return {first, text.substr(at, 1), true};
  const size_t length = first >= 0xF0 && first < 0xF5   ? 4
                        : first >= 0xE0 && first < 0xF0 ? 3
                        : first >= 0xC2 && first < 0xE0 ? 2
                                                        : 0;
  uint32_t code = length == 4 ? first & 0x07 : length == 3 ? first & 0x0F : first & 0x1F;
  for (size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return {first, text.substr(at, 1), false};
    code = code << 6 | (byte(k) & 0x3F);
  }
  // Overlong forms, surrogates and what is beyond Unicode.
  const bool wrong = length == 0 || (length == 3 && code < 0x800) ||
                     (length == 4 && (code < 0x10000 || code > 0x10FFFF)) ||
                     (code >= 0xD800 && code < 0xE000);
  if (wrong) return {first, text.substr(at, 1), false};
  return {code, text.substr(at, length), true};
}

template <typename See>
void for_each_symbol(std::string_view text, See see) {
  for (size_t at = 0; at < text.size();) {
    const Symbol symbol = symbol_at(text, at);
    see(symbol);
    at += symbol.bytes.size();
  }
}

// Controls (C0, DEL, C1), and the marks that Unicode ignores in drawing or that reorder what follows.
bool is_hidden(uint32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0xAD || c == 0x61C || (c >= 0x200B && c <= 0x200F) ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF ||
         (c >= 0xFFF9 && c <= 0xFFFB) || (c >= 0xE0000 && c <= 0xE0FFF);
}

std::string escape_of(const Symbol& symbol) {
  if (symbol.code == '\n') return "\\n";
  if (symbol.code == '\t') return "\\t";
  if (symbol.code == '\r') return "\\r";
  if (!symbol.valid || symbol.code < 0x80) return fmt::format("\\x{:02x}", symbol.code);
  return symbol.code < 0x10000 ? fmt::format("\\u{:04x}", symbol.code)
                               : fmt::format("\\U{:08x}", symbol.code);
}

// Hidden symbols escaped, but for those of `kept`.
std::string shown(const std::string& text, std::string_view kept) {
  std::string out;
  for_each_symbol(text, [&](const Symbol& symbol) {
    const bool stays =
        symbol.code < 0x80 && kept.find(static_cast<char>(symbol.code)) != std::string_view::npos;
    if (symbol.valid && (stays || !is_hidden(symbol.code)))
      out += symbol.bytes;
    else
      out += escape_of(symbol);
  });
  return out;
}

// JSON and TOML alike: \u with four digits, in pairs beyond 16 bits, and the replacement character for no
// UTF-8.
std::string quoted_by_backslash(const std::string& text, std::string_view also, bool pairs) {
  std::string out = "\"";
  for_each_symbol(text, [&](const Symbol& symbol) {
    const uint32_t c = symbol.valid ? symbol.code : 0xFFFD;
    if (c == '"' || c == '\\')
      out += {'\\', static_cast<char>(c)};
    else if (symbol.valid && !is_hidden(c) &&
             (c >= 0x80 || also.find(static_cast<char>(c)) == std::string_view::npos))
      out += symbol.bytes;
    else if (c < 0x10000)
      out += fmt::format("\\u{:04x}", c);
    else if (pairs)
      out += fmt::format("\\u{:04x}\\u{:04x}", 0xD7C0 + (c >> 10), 0xDC00 | (c & 0x3FF));
    else
      out += fmt::format("\\U{:08x}", c);
  });
  return out + '"';
}

bool is_plain(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 0x80;
}
bool is_one_of(char c, const char* set) { return c != 0 && std::strchr(set, c) != nullptr; }

// Python's str.split and C's isspace together.
bool is_blank(uint32_t c) {
  return c <= 0x20 || c == 0x85 || c == 0xA0 || c == 0x1680 || (c >= 0x2000 && c <= 0x200A) || c == 0x202F ||
         c == 0x205F || c == 0x3000;
}

}  // namespace

size_t not_utf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const Symbol symbol = symbol_at(text, at);
    if (!symbol.valid) return at;
    at += symbol.bytes.size();
  }
  return std::string_view::npos;
}

std::string line_text(const std::string& text) { return shown(text, ""); }

std::string block_text(const std::string& text) { return shown(text, "\n"); }

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : shown(text, "\n\t")) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

std::string json_text(const std::string& text) { return quoted_by_backslash(text, "<", true); }

std::string toml_string(const std::string& text) { return quoted_by_backslash(text, "", false); }

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (const char c : line_text(text)) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

std::string gnuplot_label(const std::string& text) { return gnuplot_text(text) + " noenhanced"; }

std::string gnuplot_file(const std::string& path) {
  // A line's end cannot stand in a string of gnuplot, and another name would be another file.
  if (path.find_first_of(std::string_view("\n\r\0", 3)) != std::string::npos)
    throw InputError(fmt::format("gnuplot cannot open '{}': the path has a line's end", path));
  std::string out = path.starts_with('/') ? "'" : "'./";
  for (const char c : path) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

std::string shell_word(const std::string& text) {
  const bool plain =
      std::ranges::all_of(text, [](char c) { return is_plain(c) || is_one_of(c, "_./:@%+=,-"); });
  if (plain && !text.empty()) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string tcl_word(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n')
      out += "\\n";
    else if (is_plain(c) || is_one_of(c, "_./-") || static_cast<unsigned char>(c) >= 0x80)
      out += c;
    else
      out += {'\\', c};
  }
  return out.empty() ? "{}" : out;
}

std::string yosys_file(const std::string& path) {
  // It takes wildcards, shares (+/) and here-documents (<<) in file names, and hands some to abc, which
  // splits at ';' and runs what follows '!'.
  const bool plain = std::ranges::all_of(path, [](char c) {
    return is_plain(c) || static_cast<unsigned char>(c) >= 0x80 || is_one_of(c, " _./+-=@,:~%^()");
  });
  if (!plain || path.empty())
    throw InputError(fmt::format("yosys cannot be given a file called '{}'", path),
                     "letters, digits, blanks and _ . / + - = @ , : ~ % ^ ( ) may stand in a path");
  return fmt::format("\"{}{}\"", path.starts_with('/') ? "" : "./", path);
}

std::string xyz_word(const std::string& text) {
  std::string out;
  for_each_symbol(text, [&](const Symbol& symbol) {
    if (symbol.valid && !is_blank(symbol.code) && !is_hidden(symbol.code) && symbol.code != '"')
      out += symbol.bytes;
    else
      out += '_';
  });
  return out.empty() ? "_" : out;
}

std::string file_word(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += is_plain(c) || c == '_' || c == '-' ? std::string(1, c)
                                               : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  constexpr size_t kMost = 80, kHash = 16;
  if (out.size() <= kMost) return out;
  Hash hash;
  for (const char c : text) hash.add(c);
  return fmt::format("{}-{:016x}", out.substr(0, kMost - kHash - 1), hash.value());
}

}  // namespace cuboct
