#include "tests/support/chaos_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "shared/base/text.h"

namespace macula::support {
namespace {

using TimePoint = std::chrono::steady_clock::time_point;
using std::chrono::nanoseconds;

constexpr std::size_t kChunkBytes = 16384;
constexpr int kSocketBufferBytes = 65536;  ///< small, so that the link's own buffer is the one felt
constexpr nanoseconds kLongestSleep = std::chrono::milliseconds{100};
constexpr std::size_t kPacketBytes = 1448;  ///< of payload, on Ethernet with time stamps

/// A file descriptor with an owner.
class Fd {
 public:
  Fd() = default;
  explicit Fd(int fd) : fd_(fd) {}
  Fd(Fd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Fd& operator=(Fd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Fd() {
    if (fd_ >= 0) ::close(fd_);
  }
  int value() const { return fd_; }
  bool valid() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// What one direction does, shared by the pipes of all connections.
struct Lane {
  LinkShape shape;
  LinkTrace trace;  ///< empty: the shape stays
  TimePoint trace_start{};
  bool stalled = false;
  std::optional<std::uint64_t> flip_in;  ///< bytes still to enter before the flip
  std::uint64_t bytes = 0, flipped = 0;

  /// Takes the shape of `now`; answers when it changes next.
  std::optional<TimePoint> follow(TimePoint now);
};

std::optional<TimePoint> Lane::follow(TimePoint now) {
  if (trace.steps.empty()) return std::nullopt;
  const nanoseconds lasts = std::max(trace.lasts, trace.steps.back().at + nanoseconds{1});
  const nanoseconds since = (now - trace_start) % lasts;
  const auto next = std::upper_bound(trace.steps.begin() + 1, trace.steps.end(), since,
                                     [](nanoseconds t, const auto& step) { return t < step.at; });
  shape = std::prev(next)->shape;
  return now + ((next == trace.steps.end() ? lasts : next->at) - since);
}

/// One direction of one connection: a delay line with a rate limit at its end.
class Pipe {
 public:
  bool wants_bytes(const Lane& lane) const {
    return !ended_ && !lane.stalled && held_ < lane.shape.buffer_bytes;
  }
  /// When the next byte may leave; nullopt while nothing waits.
  std::optional<TimePoint> due(const Lane& lane) const {
    if (chunks_.empty() || lane.stalled) return std::nullopt;
    return std::max(chunks_.front().due, line_free_);
  }
  bool drained() const { return ended_ && chunks_.empty(); }

  void read_from(int fd, Lane& lane, TimePoint now, std::mt19937_64& random);
  /// False when the receiver is gone.
  bool write_to(int fd, Lane& lane);

 private:
  struct Chunk {
    std::vector<std::uint8_t> bytes;
    std::size_t sent = 0;
    TimePoint due;
  };
  std::deque<Chunk> chunks_;
  std::size_t held_ = 0;
  TimePoint line_free_{}, last_due_{};
  bool ended_ = false;
};

void flip_if_its_turn(std::vector<std::uint8_t>& bytes, Lane& lane, std::mt19937_64& random) {
  if (!lane.flip_in) return;
  if (*lane.flip_in >= bytes.size()) {
    *lane.flip_in -= bytes.size();
    return;
  }
  bytes[*lane.flip_in] ^= static_cast<std::uint8_t>(1U << (random() % 8U));
  lane.flip_in.reset();
  ++lane.flipped;
}

/// Losses among the packets of a chunk are mended together (selective acknowledgements, RFC 2018);
/// a resent packet may be lost again.
nanoseconds delay_by_losses(std::size_t bytes, const LinkShape& shape, std::mt19937_64& random) {
  if (shape.loss <= 0.0) return nanoseconds{0};
  const auto packets = static_cast<long>((bytes + kPacketBytes - 1) / kPacketBytes);
  std::binomial_distribution<long> lost(packets, shape.loss);
  if (lost(random) == 0) return nanoseconds{0};
  std::geometric_distribution<long> lost_again(1.0 - shape.loss);
  return (1 + lost_again(random)) * shape.loss_stall;
}

void Pipe::read_from(int fd, Lane& lane, TimePoint now, std::mt19937_64& random) {
  Chunk chunk;
  chunk.bytes.resize(std::min(kChunkBytes, lane.shape.buffer_bytes - held_));
  const ssize_t count = ::recv(fd, chunk.bytes.data(), chunk.bytes.size(), MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) {
    ended_ = true;
    return;
  }
  chunk.bytes.resize(static_cast<std::size_t>(count));
  held_ += chunk.bytes.size();
  flip_if_its_turn(chunk.bytes, lane, random);
  std::uniform_int_distribution<nanoseconds::rep> extra(0, lane.shape.jitter.count());
  chunk.due = std::max(last_due_, now + lane.shape.delay + nanoseconds{extra(random)} +
                                      delay_by_losses(chunk.bytes.size(), lane.shape, random));
  last_due_ = chunk.due;
  chunks_.push_back(std::move(chunk));
}

bool Pipe::write_to(int fd, Lane& lane) {
  Chunk& chunk = chunks_.front();
  const TimePoint due = chunk.due;
  std::size_t count = chunk.bytes.size() - chunk.sent;
  const double rate = lane.shape.bytes_per_s;
  if (rate > 0.0) count = std::min(count, 1 + static_cast<std::size_t>(rate * 5e-3));
  const ssize_t sent =
      ::send(fd, chunk.bytes.data() + chunk.sent, count, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) return errno == EAGAIN || errno == EINTR;
  const auto done = static_cast<std::size_t>(sent);
  chunk.sent += done;
  held_ -= done;
  lane.bytes += done;
  if (rate > 0.0) {
    const auto takes = nanoseconds{static_cast<nanoseconds::rep>(1e9 * double(done) / rate)};
    // From when the line could take the bytes, not from when this thread came to it: a thread that
    // wakes late must not make the link slower than it is said to be.
    line_free_ = std::max(line_free_, due) + takes;
  }
  if (chunk.sent == chunk.bytes.size()) chunks_.pop_front();
  return true;
}

struct Connection {
  Fd client, server;
  Pipe up, down;
  bool half_open = false;  ///< both ends talk to nobody
  std::array<std::optional<std::size_t>, 2>
      poll_slots;  ///< client, server in this round's poll set
};

std::optional<sockaddr_in> parse_endpoint(const std::string& endpoint) {
  const std::string scheme = "tcp://";
  const std::size_t colon = endpoint.rfind(':');
  if (endpoint.rfind(scheme, 0) != 0 || colon < scheme.size()) return std::nullopt;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::atoi(endpoint.c_str() + colon + 1)));
  const std::string host = endpoint.substr(scheme.size(), colon - scheme.size());
  if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) return std::nullopt;
  return address;
}

Fd connect_to(const sockaddr_in& address) {
  Fd fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ::setsockopt(fd.value(), SOL_SOCKET, SO_RCVBUF, &kSocketBufferBytes, sizeof kSocketBufferBytes);
  ::setsockopt(fd.value(), SOL_SOCKET, SO_SNDBUF, &kSocketBufferBytes, sizeof kSocketBufferBytes);
  const int on = 1;
  ::setsockopt(fd.value(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  // Loopback answers at once, so a blocking connect cannot hold the proxy up.
  if (::connect(fd.value(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return Fd{};
  }
  return fd;
}

class Proxy final : public ChaosProxy {
 public:
  Proxy(Fd listener, std::string endpoint, const sockaddr_in& server, std::uint64_t seed)
      : listener_(std::move(listener)),
        wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
        endpoint_(std::move(endpoint)),
        server_(server),
        random_(seed),
        thread_([this] { run(); }) {}

  ~Proxy() override {
    change([this] { stopping_ = true; });
    thread_.join();
  }

  std::string endpoint() const override { return endpoint_; }
  void lead_to(const std::string& server) override {
    change([&] { server_ = parse_endpoint(server); });
  }
  void shape(Direction direction, const LinkShape& shape) override {
    change([&] {
      lane(direction).shape = shape;
      lane(direction).trace = {};
    });
  }
  void follow(Direction direction, LinkTrace trace) override {
    change([&] {
      lane(direction).trace = std::move(trace);
      lane(direction).trace_start = std::chrono::steady_clock::now();
    });
  }
  void flip_bit_after(Direction direction, std::uint64_t skip) override {
    change([&] { lane(direction).flip_in = skip; });
  }
  void stall(Direction direction) override {
    change([&] { lane(direction).stalled = true; });
  }
  void resume(Direction direction) override {
    change([&] { lane(direction).stalled = false; });
  }
  void cut() override {
    change([this] { connections_.clear(); });
  }
  void reset() override {
    change([this] {
      const linger at_once{1, 0};
      for (const Connection& c : connections_) {
        for (const Fd* fd : {&c.client, &c.server}) {
          ::setsockopt(fd->value(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        }
      }
      connections_.clear();
    });
  }
  void leave_half_open() override {
    change([this] {
      for (Connection& c : connections_) c.half_open = true;
    });
  }
  std::uint64_t bytes(Direction direction) const override {
    std::lock_guard lock(mutex_);
    return lanes_[static_cast<std::size_t>(direction)].bytes;
  }
  std::uint64_t bits_flipped() const override {
    std::lock_guard lock(mutex_);
    return lanes_[0].flipped + lanes_[1].flipped;
  }
  std::uint64_t connections_taken() const override {
    std::lock_guard lock(mutex_);
    return taken_;
  }

 private:
  template <class Change>
  void change(Change&& apply) {
    {
      std::lock_guard lock(mutex_);
      apply();
      ++generation_;
    }
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake_.value(), &one, sizeof one);
  }
  Lane& lane(Direction direction) { return lanes_[static_cast<std::size_t>(direction)]; }
  Lane& up() { return lane(Direction::ToServer); }
  Lane& down() { return lane(Direction::ToClient); }

  void run();
  nanoseconds plan_round(TimePoint now);
  void watch(std::optional<std::size_t>& slot, int fd, int events);
  void serve_round(TimePoint now);
  bool serve(Connection& connection, TimePoint now);
  void take_connection();

  mutable std::mutex mutex_;  ///< guards everything but the poll itself
  Fd listener_, wake_;
  const std::string endpoint_;
  std::optional<sockaddr_in> server_;
  std::mt19937_64 random_;
  std::array<Lane, 2> lanes_;
  std::list<Connection> connections_;
  std::vector<pollfd> polled_;
  std::uint64_t taken_ = 0, generation_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

void Proxy::run() {
  for (;;) {
    std::vector<pollfd> waiting;
    nanoseconds sleep{0};
    std::uint64_t generation = 0;
    {
      std::lock_guard lock(mutex_);
      if (stopping_) return;
      sleep = plan_round(std::chrono::steady_clock::now());
      waiting = polled_;
      generation = generation_;
    }
    const timespec timeout{sleep.count() / 1'000'000'000, sleep.count() % 1'000'000'000};
    ::ppoll(waiting.data(), waiting.size(), &timeout, nullptr);
    std::uint64_t wakes = 0;
    [[maybe_unused]] const ssize_t read = ::read(wake_.value(), &wakes, sizeof wakes);
    std::lock_guard lock(mutex_);
    if (generation != generation_) continue;  // the set may name descriptors that are gone
    polled_ = std::move(waiting);
    serve_round(std::chrono::steady_clock::now());
  }
}

void Proxy::watch(std::optional<std::size_t>& slot, int fd, int events) {
  slot.reset();
  if (events == 0) return;
  slot = polled_.size();
  polled_.push_back({fd, static_cast<short>(events), 0});
}

/// Fills the poll set and answers how long to sleep.
nanoseconds Proxy::plan_round(TimePoint now) {
  polled_.assign({{wake_.value(), POLLIN, 0}, {listener_.value(), POLLIN, 0}});
  nanoseconds sleep = kLongestSleep;
  const auto writes = [&](const Pipe& pipe, const Lane& lane) {
    const auto due = pipe.due(lane);
    if (!due) return 0;
    if (*due <= now) return int{POLLOUT};
    sleep = std::min(sleep, std::chrono::duration_cast<nanoseconds>(*due - now));
    return 0;
  };
  for (Lane& lane : lanes_) {
    if (const auto change = lane.follow(now)) {
      sleep = std::min(sleep, std::chrono::duration_cast<nanoseconds>(*change - now));
    }
  }
  for (Connection& c : connections_) {
    if (c.half_open) {
      watch(c.poll_slots[0], c.client.value(), c.client.valid() ? POLLIN : 0);
      watch(c.poll_slots[1], c.server.value(), c.server.valid() ? POLLIN : 0);
      continue;
    }
    const int reads_up = c.up.wants_bytes(up()) ? POLLIN : 0;
    const int reads_down = c.down.wants_bytes(down()) ? POLLIN : 0;
    watch(c.poll_slots[0], c.client.value(), reads_up | writes(c.down, down()));
    watch(c.poll_slots[1], c.server.value(), reads_down | writes(c.up, up()));
  }
  return sleep;
}

/// Reads and forgets; an end that closed is closed here too, which tells the other nothing.
void swallow(Fd& end) {
  std::array<char, kChunkBytes> lost;
  const ssize_t count = ::recv(end.value(), lost.data(), lost.size(), MSG_DONTWAIT);
  if (count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR))) return;
  end = Fd{};
}

/// False when the connection is over.
bool Proxy::serve(Connection& c, TimePoint now) {
  const auto ready = [&](std::size_t side) {
    return c.poll_slots[side] ? polled_[*c.poll_slots[side]].revents : short{0};
  };
  constexpr int kReadable = POLLIN | POLLHUP | POLLERR;
  const int client = ready(0), server = ready(1);
  if (c.half_open) {
    if ((client & kReadable) != 0) swallow(c.client);
    if ((server & kReadable) != 0) swallow(c.server);
    return c.client.valid() || c.server.valid();
  }
  if ((client & kReadable) != 0 && c.up.wants_bytes(up())) {
    c.up.read_from(c.client.value(), up(), now, random_);
  }
  if ((server & kReadable) != 0 && c.down.wants_bytes(down())) {
    c.down.read_from(c.server.value(), down(), now, random_);
  }
  if ((client & POLLOUT) != 0 && !c.down.write_to(c.client.value(), down())) return false;
  if ((server & POLLOUT) != 0 && !c.up.write_to(c.server.value(), up())) return false;
  return !c.up.drained() && !c.down.drained();
}

void Proxy::serve_round(TimePoint now) {
  for (Lane& lane : lanes_) lane.follow(now);
  connections_.remove_if([&](Connection& c) { return !serve(c, now); });
  if ((polled_[1].revents & POLLIN) != 0) take_connection();
}

void Proxy::take_connection() {
  Fd client(::accept4(listener_.value(), nullptr, nullptr, SOCK_CLOEXEC));
  if (!client.valid()) return;
  ++taken_;
  const int on = 1;
  ::setsockopt(client.value(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  Fd server = server_ ? connect_to(*server_) : Fd{};
  if (!server.valid()) return;  // closing the client's end says that nobody is there
  connections_.push_back({std::move(client), std::move(server), {}, {}, false, {}});
}

}  // namespace

Result<std::unique_ptr<ChaosProxy>> ChaosProxy::create(const std::string& server,
                                                       std::uint64_t seed) {
  const auto address = parse_endpoint(server);
  if (!address) return base::bad_input("not tcp://A.B.C.D:PORT", server);
  Fd listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  for (const int option : {SO_RCVBUF, SO_SNDBUF}) {  // accepted sockets inherit both
    ::setsockopt(listener.value(), SOL_SOCKET, option, &kSocketBufferBytes,
                 sizeof kSocketBufferBytes);
  }
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  auto* const raw = reinterpret_cast<sockaddr*>(&own);
  if (::bind(listener.value(), raw, size) != 0 || ::listen(listener.value(), 64) != 0 ||
      ::getsockname(listener.value(), raw, &size) != 0) {
    return base::runtime_error(base::concat("no port to listen on: ", std::strerror(errno)));
  }
  const std::string endpoint = base::concat("tcp://127.0.0.1:", ntohs(own.sin_port));
  return std::make_unique<Proxy>(std::move(listener), endpoint, *address, seed);
}

}  // namespace macula::support
