// SPDX-License-Identifier: MIT
// cuboct-read-trace WHAT FILE SECONDS MEGABYTES: the program that reads a stranger's traces by HDF5, which
// some files crash. model/trace/guarded_trace.cpp runs it and takes what it writes to standard output.
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <string>

#include "model/base/error.h"
#include "model/base/guarded_reader.h"
#include "model/base/standard_streams.h"
#include "model/trace/guarded_trace.h"
#include "model/trace/hand_over.h"
#include "model/trace/trace_file.h"

namespace cuboct {
namespace {

struct Giver {
  void move(const void* from, size_t bytes) const {
    if (std::fwrite(from, 1, bytes, stdout) != bytes) throw std::runtime_error("nobody reads");
  }
  void expect(uint64_t, size_t) const {}
};

void give_trace(const std::string& path, HandOver<const Giver>& pass) {
  const TraceReader reader(path);
  Trace rest = reader.rest();
  pass(rest);
  const auto give = [&](TracePart part, auto frame) { pass(part, frame); };
  reader.frames([&](State frame) { give(TracePart::frame, std::move(frame)); });
  reader.bodies([&](RealFrame frame) { give(TracePart::body, std::move(frame)); });
  TracePart end = TracePart::end;
  pass(end);
}

void give(const std::string& what, const std::string& path) {
  const Giver to;
  HandOver pass(to);
  if (what == kReadTrace) {
    give_trace(path, pass);
  } else if (what == kReadLeftState) {
    LeftState left = read_left_state(path);
    pass(left);
  } else if (what == kReadRasters) {
    Rasters rasters = read_rasters(path);
    pass(rasters);
  } else {
    throw std::runtime_error("it reads no " + what);
  }
  if (std::fflush(stdout) != 0) throw std::runtime_error("nobody reads");
}

}  // namespace
}  // namespace cuboct

int main(int count, char** words) try {
  cuboct::fill_standard_descriptors();
  if (count != 5) throw std::runtime_error("usage: cuboct-read-trace WHAT FILE SECONDS MEGABYTES");
  // Ctrl-C in a terminal comes to us too. Whoever reads ends us, if that is what follows from it.
  std::signal(SIGINT, SIG_IGN);
  cuboct::take_limits({std::stoull(words[3]), std::stoull(words[4])});
  cuboct::give(words[1], words[2]);
  _exit(0);  // what HDF5 still holds it need not free
} catch (const std::bad_alloc&) {
  const cuboct::InputError error(fmt::format("cannot read {}: it takes more memory than is free", words[2]));
  fmt::print(stderr, "{}", error.what());
  return 2;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}", error.what());
  return 2;
}
