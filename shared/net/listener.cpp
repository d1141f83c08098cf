#include "shared/net/listener.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "shared/base/text.h"
#include "shared/net/zap.h"

namespace macula::net {
namespace {

constexpr const char* kAllowed =
    "tcp://ADDRESS:PORT with a numeric address of this machine or *, and a port of 0..65535 or *";
constexpr int kBacklog = 64;
constexpr int kNotSentLowat_bytes = 16384;

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

struct HostPort {
  std::string host, port;
};

Result<HostPort> split(const std::string& bind) {
  const std::string scheme = "tcp://";
  const std::size_t colon = bind.rfind(':');
  if (bind.rfind(scheme, 0) != 0 || colon == std::string::npos || colon <= scheme.size()) {
    return base::bad_input("not an address to listen on", bind, kAllowed);
  }
  HostPort parts{bind.substr(scheme.size(), colon - scheme.size()), bind.substr(colon + 1)};
  if (parts.port == "*") parts.port = "0";
  const bool digits = parts.port.find_first_not_of("0123456789") == std::string::npos;
  if (parts.port.empty() || parts.port.size() > 5 || !digits || std::stoi(parts.port) > 65535) {
    return base::bad_input(base::concat("port '", parts.port, "'"), bind, kAllowed);
  }
  if (parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']') {
    parts.host = parts.host.substr(1, parts.host.size() - 2);
  }
  return parts;
}

Result<Addresses> resolve(const HostPort& parts, const std::string& bind) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_family = parts.host == "*" ? AF_INET : AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  const std::string host = parts.host == "localhost" ? "127.0.0.1" : parts.host;
  addrinfo* found = nullptr;
  const int status =
      ::getaddrinfo(host == "*" ? nullptr : host.c_str(), parts.port.c_str(), &hints, &found);
  if (status != 0) return base::bad_input(::gai_strerror(status), bind, kAllowed);
  return Addresses(found, &::freeaddrinfo);
}

tl::unexpected<Error> bind_failure(int error, const std::string& bind) {
  switch (error) {
    case EADDRINUSE:
      return base::bad_input(
          "the address is in use", bind,
          "another server runs there: stop it, or choose another port with --bind");
    case EADDRNOTAVAIL:
      return base::bad_input("this machine has no such address", bind,
                             "choose one of its own with --bind, or tcp://*:PORT for all");
    case EACCES:
      return base::bad_input("this port is reserved", bind, "choose one above 1023 with --bind");
    default:
      return base::runtime_error(std::strerror(error), bind);
  }
}

std::string endpoint_of(int fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) return {};
  char host[INET6_ADDRSTRLEN] = {};
  if (address.ss_family == AF_INET6) {
    const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address);
    ::inet_ntop(AF_INET6, &v6.sin6_addr, host, sizeof host);
    return base::concat("tcp://[", host, "]:", ntohs(v6.sin6_port));
  }
  const auto& v4 = reinterpret_cast<const sockaddr_in&>(address);
  ::inet_ntop(AF_INET, &v4.sin_addr, host, sizeof host);
  return base::concat("tcp://", host, ":", ntohs(v4.sin_port));
}

}  // namespace

Result<Listener> listen_on(const std::string& bind) {
  const auto parts = split(bind);
  if (!parts) return forward(parts);
  const auto addresses = resolve(*parts, bind);
  if (!addresses) return forward(addresses);
  const addrinfo& address = **addresses;
  Fd fd(::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd.valid()) return bind_failure(errno, bind);
  const int on = 1;
  ::setsockopt(fd.value(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  ::setsockopt(fd.value(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kNotSentLowat_bytes,
               sizeof kNotSentLowat_bytes);
  if (::bind(fd.value(), address.ai_addr, address.ai_addrlen) != 0 ||
      ::listen(fd.value(), kBacklog) != 0) {
    return bind_failure(errno, bind);
  }
  std::string endpoint = endpoint_of(fd.value());
  return Listener{std::move(fd), std::move(endpoint)};
}

bool is_beyond_loopback(const std::string& endpoint) {
  const auto parts = split(endpoint);
  return parts && !is_loopback_address(parts->host);
}

}  // namespace macula::net
