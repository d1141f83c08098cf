// A TCP proxy on loopback that misbehaves on purpose: delay, jitter, a rate limit, losses as TCP
// shows them, recorded links, one flipped bit, stalls, cuts, resets and half-open connections. One
// thread of its own, no privileges; every chance comes from the seed. All public members are
// thread-safe and, unless they say otherwise, act on the connections that exist now and on later
// ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::support {

enum class Direction { ToServer, ToClient };

/// How one direction carries bytes. The defaults carry them at once.
struct LinkShape {
  std::chrono::nanoseconds delay{0};   ///< one way, added to every byte
  std::chrono::nanoseconds jitter{0};  ///< uniform extra in [0, jitter] per chunk; order is kept
  double bytes_per_s = 0.0;            ///< 0 = no limit; 2 Mbit/s is 250e3
  std::size_t buffer_bytes = 65536;    ///< what the link holds before the sender feels it
  /// Chance that a packet of 1448 bytes is lost. TCP shows a loss as a stall: the packet comes
  /// `loss_stall` later (a round trip with fast retransmission), and nothing behind it before it.
  /// Losses of one flight are mended together.
  double loss = 0.0;
  std::chrono::nanoseconds loss_stall{0};
};

/// A link that changes: from `at` (since follow()) on it has this shape. Sorted by `at`, the first
/// at 0; begins again `lasts` after its start.
struct LinkTrace {
  struct Step {
    std::chrono::nanoseconds at{0};
    LinkShape shape;
  };
  std::vector<Step> steps;
  std::chrono::nanoseconds lasts{0};
};

class ChaosProxy {
 public:
  /// `server` is "tcp://127.0.0.1:PORT". Listens on a free port of 127.0.0.1.
  static Result<std::unique_ptr<ChaosProxy>> create(const std::string& server,
                                                    std::uint64_t seed = 1);
  virtual ~ChaosProxy() = default;

  /// "tcp://127.0.0.1:PORT": where the client connects.
  virtual std::string endpoint() const = 0;
  /// Where connections made from now on lead.
  virtual void lead_to(const std::string& server) = 0;
  virtual void shape(Direction direction, const LinkShape& shape) = 0;
  /// From now on, until the next shape().
  virtual void follow(Direction direction, LinkTrace trace) = 0;
  /// Flips one bit, once, in the byte that enters this direction after `skip` more bytes.
  virtual void flip_bit_after(Direction direction, std::uint64_t skip) = 0;
  /// Nothing passes until resume(); connections stay open.
  virtual void stall(Direction direction) = 0;
  virtual void resume(Direction direction) = 0;
  /// Closes every connection now; new ones are still taken.
  virtual void cut() = 0;
  /// The same by RST: both ends read an error instead of an end.
  virtual void reset() = 0;
  /// Both ends of every connection of now vanish without a word: what is sent to them is taken and
  /// lost, and neither end hears that the other has closed. Later connections are sound.
  virtual void leave_half_open() = 0;

  /// Bytes forwarded so far, over all connections.
  virtual std::uint64_t bytes(Direction direction) const = 0;
  virtual std::uint64_t bits_flipped() const = 0;
  virtual std::uint64_t connections_taken() const = 0;
};

}  // namespace macula::support
