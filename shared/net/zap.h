// Who may connect: the ZAP handler (rfc.zeromq.org/spec/27) of one context. It answers 200 to
// exactly the keys of the allowed folder and 400 to everyone else and to every request it does not
// understand (300 would make the client retry in silence). The folder is read again for every
// handshake. Lives on the net thread; must exist before the server's socket binds, or libzmq would
// let anyone in.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/net/zmq_socket.h"

namespace macula::net {

struct ZapRequest {
  std::string version, domain, address, mechanism;
  std::string key;  ///< 32 bytes, as they came
};

class ZapHandler {
 public:
  ZapHandler(const Context& context, std::string key_folder, std::string domain);
  /// An error when another handler runs in this context.
  Result<void> start();
  /// Answers what is here; called when fd() wakes.
  void serve();
  bool has_input() const { return socket_.has_input(); }
  int fd() const { return socket_.fd(); }
  std::uint64_t refused() const { return refused_; }
  std::uint64_t admitted() const { return admitted_; }

 private:
  std::vector<std::string> answer(const std::vector<std::string>& request);
  void say_refused(const std::string& key_z85, const std::string& address);

  Socket socket_;
  const std::string folder_, domain_;
  std::vector<std::string> named_;  ///< refused keys the log has named already
  std::uint64_t refused_ = 0, admitted_ = 0;
};

/// 127.0.0.0/8 or ::1: the server's own machine.
bool is_loopback_address(const std::string& address);

/// Z85 of the client's key when the request is in order and the key is allowed, else empty.
std::string admitted_key(const ZapRequest& request, const std::string& domain,
                         const std::string& key_folder);

}  // namespace macula::net
