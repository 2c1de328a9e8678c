// SPDX-License-Identifier: MIT
#include "study/sweep/sqlite.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "model/base/input_file.h"

namespace cuboct::study {
namespace {

constexpr const char* kHint =
    "'cuboct explore' makes such a file: remove this one and begin again, or take another";

// Whatever blanks its author's source had.
std::set<std::string> schema_of(const Database& database) {
  std::set<std::string> found;
  Query row(database,
            "SELECT type || ' ' || name || ' ' || tbl_name || ' ' || ifnull(sql, '') FROM sqlite_schema");
  while (row.next()) {
    std::string text = row.text();
    std::erase(text, ' ');
    found.insert(text);
  }
  return found;
}

// SQLite would undo what a rollback journal says, and remove another file that the journal names. Ours have
// a write-ahead log.
void check_journal(const std::string& path) {
  if (std::error_code none; std::filesystem::exists(path + "-journal", none))
    throw InputError(fmt::format("{}-journal is not of cuboct, and would change {}", path, path),
                     "remove it, or both files");
}

}  // namespace

Database::Database(const std::string& path, bool writable, const std::string& name)
    : name_(name.empty() ? path : name) {
  check_is_file(path);
  check_journal(path);
  const int flags = writable ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  if (sqlite3_open_v2(path.c_str(), &handle_, flags | SQLITE_OPEN_FULLMUTEX, nullptr) != SQLITE_OK) {
    const std::string text = fmt::format("cannot open {}: {}", name_, sqlite3_errmsg(handle_));
    sqlite3_close(handle_);
    throw InputError(text);
  }
  sqlite3_busy_timeout(handle_, 10'000);
  // Another's file may hold views and triggers, and functions in them.
  for (const int refused :
       {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
    sqlite3_db_config(handle_, refused, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_exec(handle_, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
}

void Database::fail() const {
  switch (sqlite3_errcode(handle_)) {
    case SQLITE_NOTADB:
      throw InputError(fmt::format("{} holds no results of a study", name_), kHint);
    case SQLITE_CORRUPT:
      throw InputError(fmt::format("{} is damaged", name_), kHint);
    case SQLITE_ERROR:  // of a statement of ours: tables or columns are others
      throw InputError(fmt::format("{} holds no results of a study as cuboct keeps them", name_), kHint);
    default:  // a full disk, say
      throw InputError(fmt::format("{}: {}", name_, sqlite3_errmsg(handle_)));
  }
}

void Database::run(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Database::check(const std::string& tables) const {
  Database own(":memory:", true);
  own.run(tables);
  const std::set<std::string> found = schema_of(*this);
  if (!found.empty() && found != schema_of(own))
    throw InputError(fmt::format("{} holds no results of a study as cuboct keeps them", name_), kHint);
  Query pages(*this, "PRAGMA quick_check(1)");
  if (!pages.next() || pages.text() != "ok") throw InputError(fmt::format("{} is damaged", name_), kHint);
}

Query::Query(const Database& database, const std::string& sql) : database_(database) {
  if (sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK)
    database.fail();
}

Query& Query::bind(double value) {
  if (std::isnan(value) ? sqlite3_bind_null(statement_, ++bound_) != SQLITE_OK
                        : sqlite3_bind_double(statement_, ++bound_, value) != SQLITE_OK)
    database_.fail();
  return *this;
}

Query& Query::bind(int64_t value) {
  if (sqlite3_bind_int64(statement_, ++bound_, value) != SQLITE_OK) database_.fail();
  return *this;
}

Query& Query::bind(const std::string& value) {
  if (sqlite3_bind_text(statement_, ++bound_, value.data(), static_cast<int>(value.size()),
                        SQLITE_TRANSIENT) != SQLITE_OK)
    database_.fail();
  return *this;
}

Query& Query::bind_blob(const std::string& bytes) {
  if (sqlite3_bind_blob64(statement_, ++bound_, bytes.data(), bytes.size(), SQLITE_TRANSIENT) != SQLITE_OK)
    database_.fail();
  return *this;
}

bool Query::next() {
  read_ = 0;
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail();
  return code == SQLITE_ROW;
}

void Query::copy_column(int column, Query& to) {
  if (sqlite3_bind_value(to.statement_, ++to.bound_, sqlite3_column_value(statement_, column)) != SQLITE_OK)
    to.database_.fail();
}

void Query::copy_to(Query& to) {
  for (int k = 0; k < sqlite3_column_count(statement_); ++k) copy_column(k, to);
}

void Query::copy_to(Query& to, const std::string& last) {
  const int end = sqlite3_column_count(statement_) - 1;
  for (int k = 0; k < end; ++k) copy_column(k, to);
  if (sqlite3_column_bytes(statement_, end) > 0)
    copy_column(end, to);
  else
    to.bind(last);
}

double Query::real() {
  const int column = read_++;
  return sqlite3_column_type(statement_, column) == SQLITE_NULL ? std::nan("")
                                                                : sqlite3_column_double(statement_, column);
}

int64_t Query::integer() { return sqlite3_column_int64(statement_, read_++); }

std::string Query::text() { return blob(); }

std::string Query::blob() {
  const int column = read_++;
  const void* bytes = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return bytes ? std::string(static_cast<const char*>(bytes), static_cast<size_t>(size)) : std::string();
}

}  // namespace cuboct::study
