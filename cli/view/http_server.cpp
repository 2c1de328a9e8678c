// SPDX-License-Identifier: MIT
#include "cli/view/http_server.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>

#include <microhttpd.h>

#include "model/base/error.h"

namespace cuboct {
namespace {

// The library shares the connections out among the threads, and turns away what one of them has too many of.
constexpr unsigned kConnections = 1024, kThreads = 4, kPatience = 30;  // s without a byte
constexpr size_t kPiece = 1 << 18;  // bytes handed to the library at a time

std::string random_token() {
  std::array<unsigned char, 16> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system has no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

// In a time that does not tell how much of it is right.
bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differs = 0;
  for (size_t k = 0; k < a.size(); ++k) differs |= static_cast<unsigned>(a[k] ^ b[k]);
  return differs == 0;
}

std::optional<uint64_t> number_of(const char* text) {
  if (text == nullptr) return std::nullopt;
  const std::string_view all = text;
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(all.data(), all.data() + all.size(), value);
  if (error != std::errc() || end != all.data() + all.size()) return std::nullopt;
  return value;
}

// A socket of the loopback; `port` becomes the one that it has.
int listening(uint16_t& port) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  here.sin_port = htons(port);
  auto* const address = reinterpret_cast<sockaddr*>(&here);
  socklen_t size = sizeof here;
  if (listener >= 0) setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listener < 0 || bind(listener, address, size) != 0 || listen(listener, SOMAXCONN) != 0 ||
      getsockname(listener, address, &size) != 0) {
    const int error = errno;
    if (listener >= 0) close(listener);
    throw InputError(fmt::format("cannot listen on 127.0.0.1:{}: {}", port, std::strerror(error)),
                     "another --port; without it a free one is taken");
  }
  port = ntohs(here.sin_port);
  return listener;
}

ssize_t next_piece(void* body, uint64_t from, char* to, size_t most) {
  const std::string& text = **static_cast<Bytes*>(body);
  if (from >= text.size()) return MHD_CONTENT_READER_END_OF_STREAM;
  const size_t size = std::min<size_t>(most, text.size() - from);
  std::memcpy(to, text.data() + from, size);
  return static_cast<ssize_t>(size);
}

void forget(void* body) { delete static_cast<Bytes*>(body); }

MHD_Result respond(MHD_Connection* connection, const HttpAnswer& answer) {
  static const Bytes kNothing = std::make_shared<const std::string>("not found\n");
  const Bytes& body = answer.body ? answer.body : kNothing;
  // However slow a reader is, what it reads is there once for all of them.
  MHD_Response* response =
      MHD_create_response_from_callback(body->size(), kPiece, next_piece, new Bytes(body), forget);
  const std::pair<const char*, const char*> headers[] = {
      {"Content-Type", answer.type.c_str()}, {"Cache-Control", "no-store"},
      {"Referrer-Policy", "no-referrer"},    {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},           {"Cross-Origin-Resource-Policy", "same-origin"}};
  for (const auto& [name, value] : headers) MHD_add_response_header(response, name, value);
  const MHD_Result queued = MHD_queue_response(connection, static_cast<unsigned>(answer.status), response);
  MHD_destroy_response(response);
  return queued;
}

}  // namespace

struct HttpServer::Impl {
  // A name that a stranger's page had pointed here is none of ours. Browsers leave the port out where it is
  // that of HTTP.
  bool is_ours(std::string_view host) const {
    const std::string port = host_.substr(host_.find(':'));
    for (const std::string name : {"127.0.0.1", "localhost"})
      if (host == name + port || (port == ":80" && host == name)) return true;
    return false;
  }

  HttpAnswer answer_to(MHD_Connection* connection, const char* url, std::string_view method) const {
    const char* host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Host");
    const std::string_view path = url;
    if (host == nullptr || !is_ours(host)) return {};
    if (path.size() < token_.size() + 2 || path[0] != '/' || !same(path.substr(1, token_.size()), token_) ||
        path[token_.size() + 1] != '/')
      return {};
    HttpAsked asked{method == "POST", std::string(path.substr(token_.size() + 2)), {}};
    if (!asked.post && method != "GET" && method != "HEAD") return {405, {}, nullptr};
    asked.number = [connection](const char* name) {
      return number_of(MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, name));
    };
    try {
      return answer_(asked);
    } catch (const std::exception& error) {
      return {500, "text/plain; charset=utf-8", std::make_shared<const std::string>(error.what())};
    }
  }

  static MHD_Result handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char*, const char*, size_t* upload, void** seen) {
    static char first;
    if (*seen == nullptr) {  // headers alone; the body follows
      *seen = &first;
      return MHD_YES;
    }
    if (*upload > 0) {  // what is asked stands in the path
      *upload = 0;
      return MHD_YES;
    }
    return respond(connection, static_cast<const Impl*>(self)->answer_to(connection, url, method));
  }

  std::function<HttpAnswer(const HttpAsked&)> answer_;
  std::string token_, host_, address_;
  MHD_Daemon* daemon_ = nullptr;
};

HttpServer::HttpServer(uint16_t port, std::function<HttpAnswer(const HttpAsked&)> answer)
    : impl_(std::make_unique<Impl>()) {
  impl_->answer_ = std::move(answer);
  impl_->token_ = random_token();
  const int listener = listening(port);
  impl_->host_ = fmt::format("127.0.0.1:{}", port);
  impl_->address_ = fmt::format("http://{}/{}/", impl_->host_, impl_->token_);
  impl_->daemon_ = MHD_start_daemon(MHD_USE_INTERNAL_POLLING_THREAD, 0, nullptr, nullptr, Impl::handle,
                                    impl_.get(), MHD_OPTION_LISTEN_SOCKET, listener,
                                    MHD_OPTION_CONNECTION_LIMIT, kConnections, MHD_OPTION_CONNECTION_TIMEOUT,
                                    kPatience, MHD_OPTION_THREAD_POOL_SIZE, kThreads, MHD_OPTION_END);
  if (impl_->daemon_ == nullptr) {
    close(listener);
    throw std::runtime_error("libmicrohttpd cannot start");
  }
}

HttpServer::~HttpServer() { MHD_stop_daemon(impl_->daemon_); }

const std::string& HttpServer::address() const { return impl_->address_; }

}  // namespace cuboct
