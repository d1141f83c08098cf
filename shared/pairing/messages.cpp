#include "shared/pairing/messages.h"

#include <algorithm>

namespace macula::pairing {
namespace {

constexpr std::string_view kMagic = "MACP";
constexpr std::size_t kHeaderBytes = kMagic.size() + 2;

enum class Kind : std::uint8_t { Greeting = 1, Offer, Proof, Grant, Denial };

template <std::size_t N>
void put(std::string& out, const std::array<unsigned char, N>& field) {
  out.append(reinterpret_cast<const char*>(field.data()), N);
}

std::string header(Kind kind) {
  std::string out(kMagic);
  out.push_back(static_cast<char>(kVersion));
  out.push_back(static_cast<char>(kind));
  return out;
}

/// Takes fields off the front; never reads beyond the end.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <std::size_t N>
  bool take(std::array<unsigned char, N>& field) {
    if (rest_.size() < N) return false;
    std::copy_n(rest_.begin(), N, field.begin());
    rest_.remove_prefix(N);
    return true;
  }
  bool is_empty() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

std::string body(const Greeting& message) {
  std::string out = header(Kind::Greeting);
  put(out, message.nonce);
  return out;
}
std::string body(const Offer& message) {
  std::string out = header(Kind::Offer);
  put(out, message.nonce);
  put(out, message.share);
  return out;
}
std::string body(const Proof& message) {
  std::string out = header(Kind::Proof);
  put(out, message.share);
  return out + message.sealed;
}
std::string body(const Grant& message) {
  return header(Kind::Grant) + message.sealed;
}
std::string body(const Denial& message) {
  std::string out = header(Kind::Denial);
  out.push_back(static_cast<char>(message.reason));
  out.push_back(static_cast<char>(message.wait_s & 0xFFU));
  out.push_back(static_cast<char>(message.wait_s >> 8U));
  return out;
}

std::optional<Message> read_denial(Reader in) {
  std::array<unsigned char, 3> fields{};
  if (!in.take(fields) || !in.is_empty()) return std::nullopt;
  const auto reason = static_cast<DenialReason>(fields[0]);
  if (reason < DenialReason::WrongVersion || reason > DenialReason::Closed) return std::nullopt;
  return Denial{reason, static_cast<std::uint16_t>(fields[1] | fields[2] << 8U)};
}

std::optional<Message> read(Kind kind, Reader in) {
  switch (kind) {
    case Kind::Greeting: {
      Greeting message;
      if (in.take(message.nonce) && in.is_empty()) return message;
      return std::nullopt;
    }
    case Kind::Offer: {
      Offer message;
      if (in.take(message.nonce) && in.take(message.share) && in.is_empty()) return message;
      return std::nullopt;
    }
    case Kind::Proof: {
      Proof message;
      if (!in.take(message.share)) return std::nullopt;
      message.sealed = in.rest();
      return message;
    }
    case Kind::Grant:
      return Grant{std::string(in.rest())};
    case Kind::Denial:
      return read_denial(in);
  }
  return std::nullopt;
}

}  // namespace

std::string encode(const Message& message) {
  return std::visit([](const auto& one) { return body(one); }, message);
}

std::optional<std::uint8_t> version_of(std::string_view bytes) {
  if (bytes.size() <= kMagic.size() || bytes.substr(0, kMagic.size()) != kMagic)
    return std::nullopt;
  return static_cast<std::uint8_t>(bytes[kMagic.size()]);
}

std::optional<Message> decode(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes || bytes.size() > kMostBytes) return std::nullopt;
  if (version_of(bytes) != kVersion) return std::nullopt;
  return read(static_cast<Kind>(bytes[kHeaderBytes - 1]), Reader(bytes.substr(kHeaderBytes)));
}

}  // namespace macula::pairing
