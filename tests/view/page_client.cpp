// SPDX-License-Identifier: MIT
#include "tests/view/page_client.h"

#include <fmt/format.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <regex>

namespace cuboct::test {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Address address_in(const std::string& text) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(R"(http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/)"))) return {};
  return {std::stoi(found[1]), found[2]};
}

std::string ask(const Address& at, const std::string& path, const std::string& method) {
  const int made = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(at.port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (at.port > 0 && connect(made, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    const std::string words = fmt::format(
        "{} /{}/{} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n", method,
        at.token, path, at.port);
    char piece[1 << 14];
    if (write(made, words.data(), words.size()) == static_cast<ssize_t>(words.size()))
      for (ssize_t got; (got = read(made, piece, sizeof piece)) > 0;)
        answer.append(piece, static_cast<size_t>(got));
  }
  close(made);
  return answer;
}

}  // namespace cuboct::test
