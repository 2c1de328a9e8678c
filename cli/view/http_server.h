// SPDX-License-Identifier: MIT
// HTTP for the reader of this machine alone: on 127.0.0.1, below a random token.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cli/view/source.h"

namespace cuboct {

struct HttpAsked {
  bool post = false;
  std::string path;  // below the token, without the leading '/'
  std::function<std::optional<uint64_t>(const char* name)>
      number;  // of the query, in decimal digits; nothing: not there
};

struct HttpAnswer {
  int status = 404;
  std::string type = "text/plain; charset=utf-8";
  Bytes body{};
};

// Runs until it is destroyed. Without the token, or under another host's name, every request is answered by
// 404 and nothing else.
class HttpServer {
 public:
  // `answer` is called from several threads; what it throws becomes 500. `port`: 0 takes a free one.
  // InputError where the port is not to be had.
  HttpServer(uint16_t port, std::function<HttpAnswer(const HttpAsked&)> answer);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  const std::string& address() const;  // http://127.0.0.1:PORT/TOKEN/

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cuboct
