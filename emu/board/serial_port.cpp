// SPDX-License-Identifier: MIT
#include "emu/board/serial_port.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>

#include "model/base/error.h"

namespace cuboct::emu {
namespace {

speed_t speed_of(int baud) {
  static const std::map<int, speed_t> speeds{{9600, B9600},       {19200, B19200},     {38400, B38400},
                                             {57600, B57600},     {115200, B115200},   {230400, B230400},
                                             {460800, B460800},   {500000, B500000},   {576000, B576000},
                                             {921600, B921600},   {1000000, B1000000}, {1500000, B1500000},
                                             {2000000, B2000000}, {3000000, B3000000}, {4000000, B4000000}};
  const auto at = speeds.find(baud);
  if (at != speeds.end()) return at->second;
  std::vector<int> known;
  for (const auto& [rate, speed] : speeds) known.push_back(rate);
  throw InputError(fmt::format("{} baud is no rate of serial ports", baud),
                   fmt::format("one of {}", fmt::join(known, ", ")));
}

[[noreturn]] void refuse(const std::string& path, int error) {
  if (error == ENOENT || error == ENODEV || error == ENXIO)
    throw InputError(fmt::format("there is no port {}", path),
                     "is the board plugged in? 'ls /dev/ttyUSB* /dev/ttyACM*' lists serial ports");
  if (error == EACCES || error == EPERM)
    throw InputError(
        fmt::format("no permission for port {}", path),
        "'ls -l' shows whose it is: often group dialout ('sudo usermod -aG dialout $USER', log in again)");
  if (error == EBUSY || error == EWOULDBLOCK)
    throw InputError(fmt::format("port {} is in use by another program", path), "end that one first");
  throw InputError(fmt::format("cannot open port {}: {}", path, std::strerror(error)));
}

// Of a read (0: the line hung up) or a write in a run. USB adapters that are unplugged and pseudo-terminals
// whose other end has closed differ in which of these they tell.
[[noreturn]] void lose(const std::string& path, int error) {
  if (error == 0 || error == EIO || error == ENODEV || error == ENXIO)
    throw std::runtime_error(fmt::format("port {} is gone: is the board still plugged in?", path));
  throw std::runtime_error(fmt::format("port {}: {}", path, std::strerror(error)));
}

}  // namespace

SerialPort::SerialPort(const std::string& path, int baud) : path_(path), baud_(baud) {
  const speed_t speed = speed_of(baud);
  file_ = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) refuse(path, errno);
  const auto give_up = [this](int error) {
    close(file_);
    refuse(path_, error);
  };
  termios line{};
  if (tcgetattr(file_, &line) != 0) {
    close(file_);
    throw InputError(fmt::format("{} is no serial port", path));
  }
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) give_up(errno);
  cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | PARENB | HUPCL);
  cfsetispeed(&line, speed);
  cfsetospeed(&line, speed);
  if (tcsetattr(file_, TCSANOW, &line) != 0) give_up(errno);
  ioctl(file_, TIOCEXCL);
  // USB adapters keep what came for up to 16 ms unless asked not to; ports that know nothing of that are as
  // good.
  serial_struct serial{};
  if (ioctl(file_, TIOCGSERIAL, &serial) == 0) {
    serial.flags |= ASYNC_LOW_LATENCY;
    ioctl(file_, TIOCSSERIAL, &serial);
  }
  tcflush(file_, TCIOFLUSH);
}

SerialPort::~SerialPort() {
  ioctl(file_, TIOCNXCL);
  close(file_);
}

void SerialPort::write(const Bytes& bytes) {
  for (size_t at = 0; at < bytes.size();) {
    const ssize_t done = ::write(file_, bytes.data() + at, bytes.size() - at);
    if (done > 0) {
      at += static_cast<size_t>(done);
      continue;
    }
    if (done < 0 && errno != EAGAIN && errno != EINTR) lose(path_, errno);
    pollfd waiting{file_, POLLOUT, 0};
    if (poll(&waiting, 1, 10000) == 0) throw std::runtime_error(fmt::format("port {} takes nothing", path_));
  }
}

Bytes SerialPort::read(Clock::time_point deadline) {
  Bytes bytes(4096);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count() + 1;
    pollfd waiting{file_, POLLIN, 0};
    const int ready = left <= 0 ? 0 : poll(&waiting, 1, static_cast<int>(left));
    if (ready == 0) return {};
    const ssize_t got = ready < 0 ? -1 : ::read(file_, bytes.data(), bytes.size());
    if (got > 0) {
      bytes.resize(static_cast<size_t>(got));
      return bytes;
    }
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) lose(path_, got == 0 ? 0 : errno);
  }
}

}  // namespace cuboct::emu
