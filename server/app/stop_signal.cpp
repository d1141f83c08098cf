#include "server/app/stop_signal.h"

#include <pthread.h>
#include <csignal>
#include <cstdlib>

namespace macula::server_app {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

StopSignal::StopSignal() {
  std::signal(SIGPIPE, SIG_IGN);
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  listener_ = std::thread([this] { listen(); });
}

StopSignal::~StopSignal() {
  {
    std::lock_guard lock(mutex_);
    closing_ = true;
  }
  pthread_kill(listener_.native_handle(), SIGTERM);  // ends sigwait
  listener_.join();
}

void StopSignal::listen() {
  const sigset_t set = stop_signals();
  int signal = 0;
  while (sigwait(&set, &signal) != 0) {
  }
  {
    std::lock_guard lock(mutex_);
    if (!closing_ && !serving_) std::_Exit(EXIT_SUCCESS);
    stopped_ = true;
  }
  arrived_.notify_all();
}

void StopSignal::serving() {
  std::lock_guard lock(mutex_);
  serving_ = true;
}

bool StopSignal::wait_for(std::chrono::nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, timeout, [this] { return stopped_; });
}

}  // namespace macula::server_app
