// CURVE keys in a folder (0700, files 0600), made on first use:
//   server.key server.pub   this machine's server identity
//   client.key client.pub   this machine's client identity
//   allowed/NAME.pub        clients the server lets in (exact keys); reread for every handshake
// A .pub or .key file is one line of Z85 text (40 characters).
#pragma once

#include <array>
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
using RawKey = std::array<unsigned char, 32>;
/// `z85` must be a key.
RawKey raw_key(const std::string& z85);
std::string z85_key(const RawKey& raw);

enum class Role { Server, Client };
KeyPair make_key_pair();
Result<KeyPair> load_or_make_keys(const std::string& folder, Role role);
Result<std::string> load_public_key(const std::string& file);
enum class TrustOwnClient { No, Yes };
/// Exact keys allowed now: allowed/*.pub, and client.pub of the same folder where that is trusted.
/// An Error when the process has no descriptor left to look: who is allowed is then not known.
Result<std::vector<std::string>> allowed_clients(const std::string& folder,
                                                 TrustOwnClient trust_own);
struct AllowedClient {
  std::string name;        ///< of the file allowed/NAME.pub
  std::string public_z85;  ///< empty: the file holds no key and admits nobody
};
/// By name; nobody when there is no folder yet.
std::vector<AllowedClient> list_clients(const std::string& folder);
/// Writes allowed/NAME.pub.
Result<void> allow_client(const std::string& folder, const std::string& name,
                          const std::string& public_z85);
/// Allows a client that calls itself `wanted`: made into a file name, and with -2, -3, ... where
/// another key has it already. The name it got; a key that is allowed already keeps its own.
Result<std::string> allow_new_client(const std::string& folder, const std::string& wanted,
                                     const std::string& public_z85);
/// Removes allowed/NAME.pub; an error lists the names there are.
Result<void> revoke_client(const std::string& folder, const std::string& name);
/// Writes server.pub, the server this client trusts from now on.
Result<void> remember_server(const std::string& folder, const std::string& public_z85);

}  // namespace macula::net
