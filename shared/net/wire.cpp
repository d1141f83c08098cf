#include "shared/net/wire.h"

#include <macula/v1/envelope.pb.h>

#include <cstring>
#include <type_traits>

#include "shared/base/text.h"
#include "shared/net/wire_parts.h"

namespace macula::net {
namespace {

constexpr char kMagic[] = {'M', 'A', 'C'};
constexpr std::size_t kPrefixBytes = sizeof kMagic + 1;

/// The empty body of an envelope that a message of the given type goes into.
v1::Hello& body_for(const Hello&, v1::Envelope& out) {
  return *out.mutable_hello();
}
v1::Welcome& body_for(const Welcome&, v1::Envelope& out) {
  return *out.mutable_welcome();
}
v1::Refusal& body_for(const Refusal&, v1::Envelope& out) {
  return *out.mutable_refusal();
}
v1::Settings& body_for(const Settings&, v1::Envelope& out) {
  return *out.mutable_settings();
}
v1::Bye& body_for(const Bye&, v1::Envelope& out) {
  return *out.mutable_bye();
}
v1::ViewState& body_for(const ViewState&, v1::Envelope& out) {
  return *out.mutable_view_state();
}
v1::Acks& body_for(const Acks&, v1::Envelope& out) {
  return *out.mutable_acks();
}
v1::FrameBegin& body_for(const FrameBegin&, v1::Envelope& out) {
  return *out.mutable_frame_begin();
}
v1::Slice& body_for(const SliceHeader&, v1::Envelope& out) {
  return *out.mutable_slice();
}
v1::FrameEnd& body_for(const FrameEnd&, v1::Envelope& out) {
  return *out.mutable_frame_end();
}
v1::Ping& body_for(const Ping&, v1::Envelope& out) {
  return *out.mutable_ping();
}
v1::Pong& body_for(const Pong&, v1::Envelope& out) {
  return *out.mutable_pong();
}
v1::Beat& body_for(const Beat&, v1::Envelope& out) {
  return *out.mutable_beat();
}

template <class T>
Result<Message> as_message(Result<T> read) {
  if (!read) return forward(read);
  return Message{std::move(*read)};
}

Result<Message> read_body(const v1::Envelope& in, const Limits& limits) {
  switch (in.body_case()) {
    case v1::Envelope::kHello:
      return as_message(wire::read(in.hello(), limits));
    case v1::Envelope::kWelcome:
      return as_message(wire::read(in.welcome(), limits));
    case v1::Envelope::kRefusal:
      return Message{wire::read(in.refusal())};
    case v1::Envelope::kSettings:
      return as_message(wire::read(in.settings()));
    case v1::Envelope::kBye:
      return Message{wire::read(in.bye())};
    case v1::Envelope::kViewState:
      return as_message(wire::read(in.view_state()));
    case v1::Envelope::kAcks:
      return Message{wire::read(in.acks())};
    case v1::Envelope::kFrameBegin:
      return as_message(wire::read(in.frame_begin(), limits));
    case v1::Envelope::kSlice:
      return Message{wire::read(in.slice())};
    case v1::Envelope::kFrameEnd:
      return as_message(wire::read(in.frame_end()));
    case v1::Envelope::kPing:
      return Message{wire::read(in.ping())};
    case v1::Envelope::kPong:
      return as_message(wire::read(in.pong()));
    case v1::Envelope::kBeat:
      return as_message(wire::read(in.beat()));
    case v1::Envelope::BODY_NOT_SET:
      break;
  }
  return base::bad_input("no message of this version", "envelope");
}

/// protobuf would otherwise print a line for every malformed string a peer sends; errors are
/// returned and counted here instead.
void silence_protobuf_log() {
  [[maybe_unused]] static const auto previous = google::protobuf::SetLogHandler(nullptr);
}

}  // namespace

std::string encode_envelope(const Message& message) {
  v1::Envelope envelope;
  std::visit([&](const auto& body) { wire::write(body, body_for(body, envelope)); }, message);
  std::string bytes(kMagic, sizeof kMagic);
  bytes.push_back(static_cast<char>(kProtocolVersion));
  envelope.AppendToString(&bytes);
  return bytes;
}

std::optional<std::uint8_t> wire_version(std::span<const std::byte> part0) {
  if (part0.size() < kPrefixBytes) return std::nullopt;
  if (std::memcmp(part0.data(), kMagic, sizeof kMagic) != 0) return std::nullopt;
  return static_cast<std::uint8_t>(part0[sizeof kMagic]);
}

Result<Message> decode_envelope(std::span<const std::byte> part0, const Limits& limits) {
  silence_protobuf_log();
  const auto version = wire_version(part0);
  if (!version) return base::bad_input("not a Macula message", "envelope", "\"MAC\" + version");
  if (*version != kProtocolVersion) {
    return base::bad_input(base::concat("the peer speaks Macula wire version ", int{*version},
                                        ", this program ", kProtocolVersion),
                           "envelope", "install the same version on both machines");
  }
  if (part0.size() > limits.max_envelope_bytes) {
    return base::bad_input(base::concat(part0.size(), " bytes"), "envelope",
                           base::concat("at most ", limits.max_envelope_bytes));
  }
  v1::Envelope envelope;
  const auto body = part0.subspan(kPrefixBytes);
  if (!envelope.ParseFromArray(body.data(), static_cast<int>(body.size()))) {
    return base::bad_input("not a Macula message", "envelope", "bytes are damaged or cut short");
  }
  const bool is_view = envelope.body_case() == v1::Envelope::kViewState;
  if (is_view && part0.size() > limits.max_view_state_bytes) {
    return base::bad_input(base::concat(part0.size(), " bytes"), "view_state",
                           base::concat("at most ", limits.max_view_state_bytes));
  }
  return read_body(envelope, limits);
}

}  // namespace macula::net
