// SPDX-License-Identifier: MIT
#include "model/base/interrupt.h"

#include <csignal>
#include <ctime>
#include <mutex>

namespace cuboct {
namespace {

volatile std::sig_atomic_t asked_to_stop = 0;
timespec first;

// All that is called here may be called in a signal handler.
void handle(int signal) {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (asked_to_stop == 0) {
    first = now;
    asked_to_stop = 1;
    return;
  }
  // `timeout` and batch systems signal a program and its group in one breath: that is one request, not two.
  const auto passed = (now.tv_sec - first.tv_sec) * 1000 + (now.tv_nsec - first.tv_nsec) / 1000000;
  if (passed < 500) return;
  struct sigaction fatal {};
  fatal.sa_handler = SIG_DFL;
  sigaction(signal, &fatal, nullptr);
  raise(signal);
}

std::mutex guard;  // of the two below
int catching = 0;
struct sigaction before_catching;

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = handle;  // no SA_RESTART: a wait for an engine must return
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
  // nohup has it ignored, and means it.
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return asked_to_stop != 0; }

void forget_interrupt() { asked_to_stop = 0; }

CatchInterrupt::CatchInterrupt() {
  const std::lock_guard lock(guard);
  if (catching++ > 0) return;
  asked_to_stop = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { asked_to_stop = 1; };
  sigaction(SIGINT, &action, &before_catching);
}

CatchInterrupt::~CatchInterrupt() {
  const std::lock_guard lock(guard);
  if (--catching > 0) return;
  sigaction(SIGINT, &before_catching, nullptr);
  asked_to_stop = 0;
}

}  // namespace cuboct
