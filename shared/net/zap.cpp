#include "shared/net/zap.h"

#include <algorithm>
#include <array>

#include "shared/base/log.h"
#include "shared/base/text.h"
#include "shared/net/keys.h"

namespace macula::net {
namespace {

constexpr const char* kEndpoint = "inproc://zeromq.zap.01";
constexpr const char* kVersion = "1.0";
constexpr std::size_t kMostNamed = 64;

std::string z85_of(const std::string& key) {
  RawKey raw{};
  if (key.size() != raw.size()) return {};
  std::copy(key.begin(), key.end(), raw.begin());
  return z85_key(raw);
}

/// Every part of one waiting request; empty when there is none.
std::vector<std::string> receive_request(const Socket& socket) {
  constexpr std::size_t kMostParts = 16;
  std::vector<std::string> parts;
  for (bool more = true; more;) {
    Part part;
    if (zmq_msg_recv(part.handle(), socket.handle(), ZMQ_DONTWAIT) < 0) break;
    more = zmq_msg_more(part.handle()) != 0;
    if (parts.size() < kMostParts) parts.emplace_back(part.text());
  }
  return parts;
}

}  // namespace

bool is_loopback_address(const std::string& address) {
  return address.rfind("127.", 0) == 0 || address == "::1" || address.rfind("::ffff:127.", 0) == 0;
}

std::string admitted_key(const ZapRequest& request, const std::string& domain,
                         const std::string& key_folder) {
  if (request.version != kVersion || request.mechanism != "CURVE" || request.domain != domain) {
    return {};
  }
  const std::string key = z85_of(request.key);
  if (key.empty()) return {};
  const bool is_own_machine = is_loopback_address(request.address);
  const auto allowed =
      allowed_clients(key_folder, is_own_machine ? TrustOwnClient::Yes : TrustOwnClient::No);
  if (!allowed) return {};  // who is allowed cannot be known now
  return std::find(allowed->begin(), allowed->end(), key) != allowed->end() ? key : std::string{};
}

ZapHandler::ZapHandler(const Context& context, std::string key_folder, std::string domain)
    : socket_(context, SocketKind::Rep),
      folder_(std::move(key_folder)),
      domain_(std::move(domain)) {
  socket_.set(ZMQ_LINGER, 0);
}

Result<void> ZapHandler::start() {
  if (auto bound = socket_.bind(kEndpoint); !bound) {
    return base::runtime_error("the handler that checks client keys could not start: " +
                               bound.error().what);
  }
  return {};
}

void ZapHandler::serve() {
  for (auto request = receive_request(socket_); !request.empty();
       request = receive_request(socket_)) {
    socket_.send_parts(answer(request));
  }
}

// Request: version, request id, domain, address, identity, mechanism, credentials.
// Answer: version, request id, status code, status text, user id, metadata.
std::vector<std::string> ZapHandler::answer(const std::vector<std::string>& request) {
  constexpr std::size_t kCurveParts = 7;
  const std::string id = request.size() > 1 ? request[1] : std::string{};
  std::string key;
  if (request.size() == kCurveParts) {
    const ZapRequest asked{request[0], request[2], request[3], request[5], request[6]};
    key = admitted_key(asked, domain_, folder_);
    if (key.empty()) say_refused(z85_of(asked.key), asked.address);
  }
  ++(key.empty() ? refused_ : admitted_);
  if (!key.empty()) return {kVersion, id, "200", "OK", key, ""};
  return {kVersion, id, "400", "this client's key is not allowed", "", ""};
}

void ZapHandler::say_refused(const std::string& key_z85, const std::string& address) {
  if (key_z85.empty() || named_.size() >= kMostNamed) return;
  if (std::find(named_.begin(), named_.end(), key_z85) != named_.end()) return;
  named_.push_back(key_z85);
  base::log_warning(base::concat("refused a client at ", address, " with unknown key ", key_z85,
                                 "; to let it in, run 'macula-server pair' here, or copy its "
                                 "client.pub to ",
                                 folder_, "/allowed/NAME.pub"));
}

}  // namespace macula::net
