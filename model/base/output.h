// SPDX-License-Identifier: MIT
// Files that a run leaves: checked before the work starts, whole or not there at all. And read again.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>

namespace cuboct {

// Throws InputError ("cannot write PATH: REASON") where a file of this name could not be written now. Leaves
// nothing.
void check_writable(const std::string& path);

// Makes the directory and those above it. Throws InputError ("cannot make the directory PATH: REASON").
void make_directory(const std::string& path);

// What is in a file. Throws std::runtime_error.
std::string read_text(const std::string& path);

// Calls `write` with a temporary name beside `path`, then renames that file to `path`. Where `write` throws,
// the temporary file is removed and `path` stays as it was. Throws InputError where the rename fails.
void write_whole(const std::string& path, const std::function<void(const std::string& temporary)>& write);

// Removes a file, and gives its space back even where somebody still has it open.
void discard(const std::string& path);

// Gives the file `temporary`, which is whole, its name, or removes it. Throws InputError where that fails.
void rename_whole(const std::string& temporary, const std::string& path);

// The name beside `path` under which write_whole has the file written: of this process alone.
std::string temporary_beside(const std::string& path);

// Takes the disk's room for bytes from ... from + bytes - 1 of a file, so that writing them cannot fail for
// want of it. The file may grow. 0, or an errno; the file is then as it was.
int reserve(const std::string& path, uint64_t from, uint64_t bytes);

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

// A file that is whole at any time while it grows: what was committed, then `tail`.
class GrowingFile {
 public:
  // Makes the file of `head` and `tail`, or empties it. Throws InputError.
  GrowingFile(std::string path, const std::string& head = {}, std::string tail = {});
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  // Buffered. Where the disk refuses, all goes that was written since the last commit, and InputError is
  // thrown.
  void write(const char* text, size_t size);
  void write(const std::string& text) { write(text.data(), text.size()); }
  void commit();

 private:
  void flush();

  std::string path_, tail_, buffer_;
  int file_;
  off_t committed_ = 0, end_ = 0;  // without the tail
};

// write_whole for a text that comes in pieces, and for one that is ready.
void write_text(const std::string& path, const std::function<void(TextFile&)>& write);
void write_text(const std::string& path, const std::string& text);

}  // namespace cuboct
