#include "shared/net/pairing_socket.h"

#include <array>
#include <utility>

#include "shared/base/text.h"
#include "shared/net/keys.h"
#include "shared/net/listener.h"
#include "shared/net/zmq_socket.h"
#include "shared/pairing/messages.h"

namespace macula::net {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kNap{20};  ///< sockets and the caller's wishes are looked at so often
constexpr int kGoodbye_ms = 500;  ///< the last answer may still leave

Limits pairing_limits() {
  Limits limits;
  limits.max_part_bytes = limits.max_envelope_bytes = pairing::kMostBytes;
  return limits;
}

/// Sleeps until the socket may have something or a nap is over.
void wait_for_input(const Socket& socket, DeadlineTimer& timer) {
  timer.arm(std::chrono::steady_clock::now() + kNap);
  if (!socket.has_input()) sleep_until_readable(std::array{socket.fd(), timer.fd()});
}

class Host final : public PairingHost {
 public:
  Host(const PairingHostOptions& options, const KeyPair& keys, const base::Clock& clock)
      : folder_(options.key_folder),
        clock_(clock),
        router_(context_, SocketKind::Router),
        state_(options.rules, {raw_key(keys.public_z85), "macula-server"}, pairing::system_random(),
               clock.now()) {}

  Result<void> open(const std::string& bind) {
    set_common_options(router_, pairing_limits());
    auto listener = listen_on(bind);
    if (!listener) return forward(listener);
    router_.set(ZMQ_USE_FD, listener->fd.value());
    if (auto bound = router_.bind(listener->endpoint); !bound) return bound;
    listener->fd.release();  // libzmq closes it with the socket
    router_.set(ZMQ_LINGER, kGoodbye_ms);
    endpoint_ = listener->endpoint;
    return {};
  }

  std::string endpoint() const override { return endpoint_; }
  const pairing::Host& state() const override { return state_; }

  Result<std::optional<std::string>> serve(Nanoseconds timeout) override {
    const Nanoseconds until = clock_.now() + timeout;
    do {
      wait_for_input(router_, timer_);
      Incoming message;
      while (router_.receive(message)) {
        if (auto guest = answer(message)) return admit(*guest);
      }
    } while (clock_.now() < until);
    return std::nullopt;
  }

 private:
  std::optional<pairing::Identity> answer(const Incoming& message) {
    constexpr std::size_t kParts = 2;  // routing id and message
    if (message.count != kParts) return std::nullopt;
    const std::string peer(message.parts[0].text());
    auto answer = [&] {
      const ReadingReceivedBytes reading;
      return state_.handle(peer, message.parts[1].text(), clock_.now());
    }();
    if (!answer.bytes.empty()) router_.send_to(peer, {answer.bytes, nullptr, 0, 0});
    return std::move(answer.paired);
  }

  Result<std::optional<std::string>> admit(const pairing::Identity& guest) {
    auto name = allow_new_client(folder_, guest.name, z85_key(guest.key));
    if (!name) return forward(name);
    return std::optional(std::move(*name));
  }

  std::string folder_, endpoint_;
  const base::Clock& clock_;
  Context context_;
  DeadlineTimer timer_;
  Socket router_;
  pairing::Host state_;
};

tl::unexpected<Error> nobody_answered(const std::string& connect) {
  return base::runtime_error("no answer", connect,
                             "run 'macula-server pair' on the server's machine and give --connect "
                             "the address it prints; it pairs for two minutes");
}

/// Until the run ends one way or the other.
Result<pairing::Identity> converse(Socket& dealer, pairing::Guest& guest,
                                   const PairingGuestOptions& options, const base::Clock& clock,
                                   const std::atomic<bool>& stop) {
  DeadlineTimer timer;
  const Nanoseconds give_up = clock.now() + options.patience;
  bool is_greeted = false;
  while (clock.now() < give_up) {
    if (stop) return base::runtime_error("interrupted while pairing", options.connect);
    // Not sent while nobody is connected; a second greeting would begin a second run.
    if (!is_greeted)
      is_greeted = dealer.send({guest.greeting(), nullptr, 0, 0}) == SendOutcome::Sent;
    wait_for_input(dealer, timer);
    Incoming message;
    while (dealer.receive(message)) {
      const pairing::GuestStep step = [&] {
        const ReadingReceivedBytes reading;
        return guest.handle(message.parts[0].text());
      }();
      if (const auto* paired = std::get_if<pairing::Paired>(&step)) return paired->host;
      if (const auto* failed = std::get_if<pairing::Failed>(&step))
        return base::runtime_error(failed->text, options.connect);
      if (const auto* say = std::get_if<pairing::Say>(&step))
        dealer.send({say->bytes, nullptr, 0, 0});
    }
  }
  return nobody_answered(options.connect);
}

}  // namespace

Result<std::unique_ptr<PairingHost>> PairingHost::create(const PairingHostOptions& options,
                                                         const base::Clock& clock) {
  const auto keys = load_or_make_keys(options.key_folder, Role::Server);
  if (!keys) return forward(keys);
  auto host = std::make_unique<Host>(options, *keys, clock);
  if (auto opened = host->open(options.bind); !opened) return forward(opened);
  return host;
}

Result<pairing::Identity> pair_with_server(const PairingGuestOptions& options,
                                           const pairing::Code& code, const base::Clock& clock,
                                           const std::atomic<bool>& stop) {
  const auto keys = load_or_make_keys(options.key_folder, Role::Client);
  if (!keys) return forward(keys);
  const Context context;
  Socket dealer(context, SocketKind::Dealer);
  set_common_options(dealer, pairing_limits());
  dealer.set(ZMQ_IPV6, options.connect.find('[') != std::string::npos ? 1 : 0);
  if (auto connected = dealer.connect(options.connect); !connected) return forward(connected);
  pairing::Guest guest(code, {raw_key(keys->public_z85), options.name}, pairing::system_random());
  auto host = converse(dealer, guest, options, clock, stop);
  if (!host) return host;
  if (auto kept = remember_server(options.key_folder, z85_key(host->key)); !kept)
    return forward(kept);
  return host;
}

}  // namespace macula::net
