// SIGINT and SIGTERM as a plain wait. Make it before any other thread, so that all of them inherit
// the blocked signals and only its own thread ever sees one. Until serving() the process simply
// ends with status 0: there is nothing to take down yet.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace macula::server_app {

class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// From here on a signal is reported by wait_for instead of ending the process.
  void serving();
  /// True once a signal came; false after `timeout`.
  bool wait_for(std::chrono::nanoseconds timeout);

 private:
  void listen();

  std::mutex mutex_;
  std::condition_variable arrived_;
  bool serving_ = false, stopped_ = false, closing_ = false;
  std::thread listener_;
};

}  // namespace macula::server_app
