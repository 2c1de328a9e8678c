// SPDX-License-Identifier: MIT
// Files that a run leaves: checked before the work starts, whole or not there at all.
#pragma once

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

// The same for a text that is ready.
void write_text(const std::string& path, const std::string& text);

}  // namespace cuboct
