// SPDX-License-Identifier: MIT
// Files that a run leaves: checked before the work starts, whole or not there at all.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace cuboct {

// Throws InputError ("cannot write PATH: REASON") where a file of this name could not be written now. Leaves
// nothing.
void check_writable(const std::string& path);

// Makes the directory and those above it. Throws InputError ("cannot make the directory PATH: REASON").
void make_directory(const std::string& path);

// Calls `write` with a temporary name beside `path`, then renames that file to `path`. Where `write` throws,
// the temporary file is removed and `path` stays as it was. Throws InputError where the rename fails.
void write_whole(const std::string& path, const std::function<void(const std::string& temporary)>& write);

// A file that is written through a buffer. Throws InputError where the disk refuses.
class TextFile {
 public:
  // `path` is the name for errors.
  TextFile(const std::string& temporary, std::string path);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  void write(const char* text, size_t size);
  void write(const std::string& text) { write(text.data(), text.size()); }
  void close();  // a full disk may only show here

 private:
  std::FILE* file_;
  std::string path_;
};

// write_whole for a text that comes in pieces, and for one that is ready.
void write_text(const std::string& path, const std::function<void(TextFile&)>& write);
void write_text(const std::string& path, const std::string& text);

}  // namespace cuboct
