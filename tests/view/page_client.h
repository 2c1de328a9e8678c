// SPDX-License-Identifier: MIT
// What a page asks its server.
#pragma once

#include <string>

namespace cuboct::test {

bool has(const std::string& text, const std::string& part);

struct Address {
  int port = 0;
  std::string token;
};

// The address in a text, once it is there.
Address address_in(const std::string& text);

// What the server says, with its head; empty where there is none.
std::string ask(const Address& at, const std::string& path, const std::string& method = "GET");

}  // namespace cuboct::test
