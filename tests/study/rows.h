// SPDX-License-Identifier: MIT
// What stands in a file of results, seen by SQLite alone.
#pragma once

#include <sqlite3.h>

#include <stdexcept>
#include <string>

namespace cuboct::test {

// The answer of a statement, values of a row parted by '|', a line per row. Empty where there is no such file
// or table (yet).
inline std::string rows(const std::string& path, const std::string& sql) {
  sqlite3* db = nullptr;
  std::string text;
  if (sqlite3_open_v2(path.c_str(), &db, SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK) {
    sqlite3_busy_timeout(db, 10'000);
    const auto row = [](void* out, int columns, char** values, char**) {
      for (int k = 0; k < columns; ++k)
        *static_cast<std::string*>(out) += std::string(values[k] ? values[k] : "null") + "|";
      *static_cast<std::string*>(out) += "\n";
      return 0;
    };
    sqlite3_exec(db, sql.c_str(), row, &text, nullptr);
  }
  sqlite3_close(db);
  return text;
}

}  // namespace cuboct::test
