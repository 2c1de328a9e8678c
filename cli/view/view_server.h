// SPDX-License-Identifier: MIT
// A page, and what it asks for of a run.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "cli/view/http_server.h"
#include "cli/view/source.h"

namespace cuboct {

class ViewServer {
 public:
  ViewServer(uint16_t port, std::shared_ptr<ViewSource> source);
  const std::string& address() const { return http_.address(); }
  // Whether a browser has asked for the page.
  bool was_opened() const { return was_opened_; }
  // What pages are told from now on: of a run that was live, what it left.
  void change(std::shared_ptr<ViewSource> source);

 private:
  HttpAnswer answer(const HttpAsked& asked);
  HttpAnswer answer_of(ViewSource& from, const HttpAsked& asked);
  std::shared_ptr<ViewSource> source() const;

  mutable std::mutex guard_;  // of the pointer
  std::shared_ptr<ViewSource> source_;
  Bytes page_;
  std::atomic<bool> was_opened_ = false;
  HttpServer http_;  // the last: it asks for the others
};

}  // namespace cuboct
