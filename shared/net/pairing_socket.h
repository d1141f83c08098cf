// Pairing over a socket of its own: no encryption (the two have no keys yet), messages of at most a
// kilobyte, and nothing but shared/pairing's protocol is spoken. Nothing here runs a thread: the
// caller's loop serves. The stream's socket and its keys are not touched.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "shared/base/clock.h"
#include "shared/base/result.h"
#include "shared/pairing/guest.h"
#include "shared/pairing/host.h"

namespace macula::net {

inline constexpr const char* kPairingBind = "tcp://*:7789";

struct PairingHostOptions {
  std::string bind = kPairingBind;
  std::string key_folder;
  pairing::HostRules rules;
};

/// A server that is being paired.
class PairingHost {
 public:
  /// Makes the server's keys where there are none. Errors name the file or address and the remedy.
  static Result<std::unique_ptr<PairingHost>> create(const PairingHostOptions& options,
                                                     const base::Clock& clock);
  virtual ~PairingHost() = default;
  virtual std::string endpoint() const = 0;  ///< with the actual port
  /// Answers what comes until `timeout` has passed or a client has proved the code; the client's
  /// name among the allowed ones.
  virtual Result<std::optional<std::string>> serve(Nanoseconds timeout) = 0;
  /// Code, time left, counters.
  virtual const pairing::Host& state() const = 0;
};

struct PairingGuestOptions {
  std::string connect;  ///< where 'macula-server pair' listens
  std::string key_folder;
  std::string name;  ///< what this machine calls itself
  Nanoseconds patience{std::chrono::seconds{10}};
};

/// One try with one code; the server's key is in the folder afterwards. Errors say what to do.
Result<pairing::Identity> pair_with_server(const PairingGuestOptions& options,
                                           const pairing::Code& code, const base::Clock& clock,
                                           const std::atomic<bool>& stop);

}  // namespace macula::net
