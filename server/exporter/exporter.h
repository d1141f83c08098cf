// The server's telemetry for Prometheus: an HTTP page in its text format (version 0.0.4, which
// OpenMetrics continues), made anew at every request from Telemetry. Off unless an address is
// given; plain HTTP without authentication, so it belongs on loopback or a trusted network. It
// tells counts and times, never keys, poses or names. prometheus-cpp has threads of its own.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/session/telemetry.h"
#include "shared/base/result.h"

namespace macula::exporter {

class Exporter {
 public:
  using Read = std::function<session::Telemetry()>;

  /// `address`: "127.0.0.1:9464"; port 0 takes a free one. `read` is called from another thread
  /// until the Exporter is gone. Errors: an address that cannot be listened on.
  static Result<std::unique_ptr<Exporter>> create(const std::string& address, Read read);
  virtual ~Exporter() = default;
  virtual int port() const = 0;
};

/// The page of these values.
std::string page_of(const session::Telemetry& telemetry);

}  // namespace macula::exporter
