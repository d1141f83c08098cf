// CURVE keys in a folder (0700, files 0600), made on first use:
//   server.key server.pub   this machine's server identity
//   client.key client.pub   this machine's client identity
//   allowed/NAME.pub        clients the server lets in (exact keys); reread for every handshake
// A .pub or .key file is one line of Z85 text (40 characters).
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::net {

struct KeyPair {
  std::string public_z85;
  std::string secret_z85;
};

/// $XDG_CONFIG_HOME/macula or ~/.config/macula: the value is given by app, this only joins.
std::string default_key_folder(const char* xdg_config_home, const char* home);

/// 40 characters of Z85 text.
bool is_key(const std::string& z85);

enum class Role { Server, Client };
KeyPair make_key_pair();
Result<KeyPair> load_or_make_keys(const std::string& folder, Role role);
Result<std::string> load_public_key(const std::string& file);
/// Exact keys allowed now: allowed/*.pub, and client.pub of the same folder when
/// `trust_own_client`.
std::vector<std::string> allowed_clients(const std::string& folder, bool trust_own_client);
/// Writes allowed/NAME.pub.
Result<void> allow_client(const std::string& folder, const std::string& name,
                          const std::string& public_z85);

}  // namespace macula::net
