#include "shared/net/keys.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include "shared/base/check.h"
#include "shared/base/text.h"
#include "shared/net/wakeup.h"

namespace macula::net {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kZ85Key = 40;  ///< characters of a 32-byte key
constexpr mode_t kFolderMode = 0700, kFileMode = 0600, kOthersMayUse = 0077;

std::string without_line_end(std::string text) {
  while (!text.empty() && std::strchr(" \t\r\n", text.back()) != nullptr) text.pop_back();
  return text;
}

/// Whether something could not be opened only because this process or machine has too much open.
bool is_shortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOMEM;
}

Result<std::string> read_key_line(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in && is_shortage(errno)) return base::runtime_error(std::strerror(errno), file);
  if (!in) return base::bad_input(base::concat("cannot read: ", std::strerror(errno)), file);
  std::array<char, kZ85Key + 8> bytes{};
  in.read(bytes.data(), bytes.size());
  const std::string key = without_line_end(
      {bytes.data(), static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount()))});
  if (is_key(key)) return key;
  return base::bad_input("not a key", file, "one line of 40 characters of Z85 text");
}

/// Nobody but the owner may use the file or folder.
Result<void> check_private(const std::string& path, mode_t wanted) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return base::bad_input(base::concat("cannot look at it: ", std::strerror(errno)), path);
  }
  if ((status.st_mode & kOthersMayUse) == 0) return {};
  const char* const mode = wanted == kFolderMode ? "700" : "600";
  return base::bad_input("other users of this machine may use these keys", path,
                         base::concat("run: chmod ", mode, " '", path, "'"));
}

Result<void> make_private_folder(const std::string& folder) {
  std::error_code error;
  const fs::path parent = fs::path(folder).parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (::mkdir(folder.c_str(), kFolderMode) != 0 && errno != EEXIST) {
    return base::bad_input(base::concat("cannot make the folder: ", std::strerror(errno)), folder,
                           "choose another with --keys");
  }
  if (!fs::is_directory(folder, error)) {
    return base::bad_input("not a folder", folder, "choose another with --keys");
  }
  return check_private(folder, kFolderMode);
}

bool write_all(int fd, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(fd, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return ::fsync(fd) == 0;
}

enum class Existing { Keep, Replace };

/// The file appears whole or not at all; with Keep, a file that is already there stays.
Result<void> write_key_file(const std::string& file, const std::string& key, Existing existing) {
  std::string temporary = file + ".XXXXXX";
  const Fd fd(::mkostemp(temporary.data(), O_CLOEXEC));
  const auto failure = [&] {
    const int error = errno;
    ::unlink(temporary.c_str());
    return base::runtime_error(base::concat("cannot write: ", std::strerror(error)), file,
                               "make room or choose another folder with --keys");
  };
  if (!fd.valid()) return failure();
  if (::fchmod(fd.value(), kFileMode) != 0 || !write_all(fd.value(), key + "\n")) return failure();
  if (existing == Existing::Replace) {
    if (::rename(temporary.c_str(), file.c_str()) != 0) return failure();
    return {};
  }
  if (::link(temporary.c_str(), file.c_str()) != 0 && errno != EEXIST) return failure();
  ::unlink(temporary.c_str());
  return {};
}

std::string public_of(const std::string& secret_z85) {
  std::array<char, kZ85Key + 1> text{};
  MACULA_CHECK(zmq_curve_public(text.data(), secret_z85.c_str()) == 0, "libzmq without CURVE");
  return text.data();
}

constexpr std::size_t kLongestName = 64;

bool is_file_name(const std::string& name) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  return !name.empty() && name.size() <= kLongestName && name.front() != '.' &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

}  // namespace

bool is_key(const std::string& z85) {
  // rfc.zeromq.org/spec/32
  constexpr std::string_view kAlphabet =
      "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";
  return z85.size() == kZ85Key && z85.find_first_not_of(kAlphabet) == std::string::npos;
}

RawKey raw_key(const std::string& z85) {
  RawKey raw{};
  MACULA_CHECK(is_key(z85) && zmq_z85_decode(raw.data(), z85.c_str()) != nullptr, "not a key");
  return raw;
}

std::string z85_key(const RawKey& raw) {
  std::array<char, kZ85Key + 1> text{};
  MACULA_CHECK(zmq_z85_encode(text.data(), raw.data(), raw.size()) != nullptr);
  return text.data();
}

std::string default_key_folder(const char* xdg_config_home, const char* home) {
  // The XDG base directory specification has relative values ignored.
  if (xdg_config_home != nullptr && xdg_config_home[0] == '/') {
    return (fs::path(xdg_config_home) / "macula").string();
  }
  return (fs::path(home == nullptr ? "." : home) / ".config" / "macula").string();
}

KeyPair make_key_pair() {
  std::array<char, kZ85Key + 1> public_text{}, secret_text{};
  MACULA_CHECK(zmq_curve_keypair(public_text.data(), secret_text.data()) == 0,
               "libzmq without CURVE");
  return {public_text.data(), secret_text.data()};
}

Result<KeyPair> load_or_make_keys(const std::string& folder, Role role) {
  if (auto made = make_private_folder(folder); !made) return forward(made);
  const std::string stem = folder + (role == Role::Server ? "/server" : "/client");
  const std::string secret_file = stem + ".key", public_file = stem + ".pub";
  if (!fs::exists(secret_file)) {
    const auto written = write_key_file(secret_file, make_key_pair().secret_z85, Existing::Keep);
    if (!written) return forward(written);
  }
  if (auto checked = check_private(secret_file, kFileMode); !checked) return forward(checked);
  const auto secret = read_key_line(secret_file);
  if (!secret) return forward(secret);
  KeyPair keys{public_of(*secret), *secret};
  // The secret key decides; a public file that is missing or of another key is written anew.
  const auto known = read_key_line(public_file);
  if (!known || *known != keys.public_z85) {
    const auto written = write_key_file(public_file, keys.public_z85, Existing::Replace);
    if (!written) return forward(written);
  }
  return keys;
}

Result<std::string> load_public_key(const std::string& file) {
  return read_key_line(file);
}

namespace {

/// The allowed folder's files by name; a key that cannot be read is empty. An Error when the files
/// are there but cannot be opened now.
Result<std::vector<AllowedClient>> read_clients(const std::string& folder) {
  std::vector<AllowedClient> clients;
  std::error_code error;
  fs::directory_iterator entry(folder + "/allowed", error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() != ".pub") continue;
    const auto key = read_key_line(entry->path().string());
    if (!key && key.error().kind == base::ErrorKind::Runtime) return forward(key);
    clients.push_back({entry->path().stem().string(), key.value_or("")});
  }
  if (error && is_shortage(error.value())) return base::runtime_error(error.message(), folder);
  std::sort(clients.begin(), clients.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return clients;
}

}  // namespace

Result<std::vector<std::string>> allowed_clients(const std::string& folder,
                                                 TrustOwnClient trust_own) {
  std::vector<std::string> keys;
  if (trust_own == TrustOwnClient::Yes) {
    auto own = read_key_line(folder + "/client.pub");
    if (!own && own.error().kind == base::ErrorKind::Runtime) return forward(own);
    if (own) keys.push_back(std::move(*own));
  }
  auto clients = read_clients(folder);
  if (!clients) return forward(clients);
  for (AllowedClient& client : *clients)
    if (!client.public_z85.empty()) keys.push_back(std::move(client.public_z85));
  return keys;
}

std::vector<AllowedClient> list_clients(const std::string& folder) {
  return read_clients(folder).value_or(std::vector<AllowedClient>{});
}

Result<void> allow_client(const std::string& folder, const std::string& name,
                          const std::string& public_z85) {
  if (!is_file_name(name)) {
    return base::bad_input(base::concat("'", name, "'"), "client name",
                           "1..64 letters, digits, '.', '_', '-', not starting with '.'");
  }
  if (!is_key(public_z85)) {
    return base::bad_input("not a key", "client key", "40 characters of Z85 text");
  }
  if (auto made = make_private_folder(folder); !made) return made;
  if (auto made = make_private_folder(folder + "/allowed"); !made) return made;
  return write_key_file(folder + "/allowed/" + name + ".pub", public_z85, Existing::Replace);
}

namespace {

/// What a stranger calls its machine, as a file name.
std::string as_file_name(const std::string& wanted) {
  std::string name;
  for (const char c : wanted.substr(0, kLongestName - 4)) {
    const bool fits = is_file_name(std::string(1, c)) || (c == '.' && !name.empty());
    name.push_back(fits ? c : '-');
  }
  return name.empty() ? "client" : name;
}

}  // namespace

Result<std::string> allow_new_client(const std::string& folder, const std::string& wanted,
                                     const std::string& public_z85) {
  const auto clients = list_clients(folder);
  for (const AllowedClient& client : clients)
    if (client.public_z85 == public_z85) return client.name;
  const auto is_taken = [&](const std::string& name) {
    return std::any_of(clients.begin(), clients.end(),
                       [&](const AllowedClient& client) { return client.name == name; });
  };
  const std::string stem = as_file_name(wanted);
  std::string name = stem;
  for (int i = 2; is_taken(name); ++i) name = base::concat(stem, "-", i);
  if (auto allowed = allow_client(folder, name, public_z85); !allowed) return forward(allowed);
  return name;
}

Result<void> revoke_client(const std::string& folder, const std::string& name) {
  const auto clients = list_clients(folder);
  std::string names;
  for (const AllowedClient& client : clients) {
    names += (names.empty() ? "" : ", ") + client.name;
    if (client.name != name) continue;
    std::error_code error;
    if (fs::remove(folder + "/allowed/" + name + ".pub", error)) return {};
    return base::runtime_error("cannot be removed: " + error.message(),
                               folder + "/allowed/" + name + ".pub");
  }
  return base::bad_input(base::concat("no client is called '", name, "'"), folder + "/allowed",
                         names.empty() ? "none is allowed" : "there are: " + names);
}

Result<void> remember_server(const std::string& folder, const std::string& public_z85) {
  if (!is_key(public_z85))
    return base::bad_input("not a key", "server key", "40 characters of Z85 text");
  if (auto made = make_private_folder(folder); !made) return made;
  return write_key_file(folder + "/server.pub", public_z85, Existing::Replace);
}

}  // namespace macula::net
