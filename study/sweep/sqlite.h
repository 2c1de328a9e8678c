// SPDX-License-Identifier: MIT
// SQLite's C interface as far as studies need it.
#pragma once

#include <sqlite3.h>

#include <string>

#include "model/base/error.h"

namespace cuboct::study {

class Database {
 public:
  // Throws InputError where the file cannot be opened. `writable`: it is made where it is not there. `name`:
  // for errors, where the file is a copy.
  Database(const std::string& path, bool writable, const std::string& name = {});
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql);
  // Of a file that may be a stranger's, before anything else is asked: what its schema says runs in our
  // statements, and a tree of pages that meets itself has no end. InputError where it has anything and not
  // just the tables that `tables` makes, or pages that do not fit together.
  void check(const std::string& tables) const;
  sqlite3* handle() const { return handle_; }
  [[noreturn]] void fail() const;

 private:
  std::string name_;
  sqlite3* handle_ = nullptr;
};

// One statement; values are bound and columns read from left to right. A nan is NULL and back.
class Query {
 public:
  Query(const Database& database, const std::string& sql);
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  Query& bind(double value);
  Query& bind(int64_t value);
  Query& bind(const std::string& value);
  Query& bind_blob(const std::string& bytes);

  bool next();  // a row is there
  void done() {
    while (next()) {
    }
  }

  // The row's columns into `to`, one after the other; the last one, of text, is `last` where it is empty.
  void copy_to(Query& to, const std::string& last);
  void copy_to(Query& to);

  double real();
  int64_t integer();
  std::string text();
  std::string blob();

 private:
  void copy_column(int column, Query& to);

  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0, read_ = 0;
};

}  // namespace cuboct::study
