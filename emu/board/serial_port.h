// SPDX-License-Identifier: MIT
// A serial port of this machine, raw, for this process alone.
#pragma once

#include <chrono>
#include <string>

#include "emu/board/frame.h"

namespace cuboct::emu {

class SerialPort {
 public:
  using Clock = std::chrono::steady_clock;

  // Throws InputError: no such port, no permission, in use, no serial port, a rate that it does not have.
  SerialPort(const std::string& path, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  const std::string& path() const { return path_; }
  int baud() const { return baud_; }

  // All of it, or std::runtime_error where the port does not take it within 10 s or is gone.
  void write(const Bytes& bytes);
  // What has come, waiting until `deadline` for the first byte; empty: nothing came. std::runtime_error where
  // the port is gone.
  Bytes read(Clock::time_point deadline);

 private:
  std::string path_;
  int baud_;
  int file_ = -1;
};

}  // namespace cuboct::emu
