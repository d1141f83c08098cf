#include "shared/net/keys.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/shared/net/net_fixture.h"

namespace macula::net {
namespace {

namespace fs = std::filesystem;

unsigned mode_of(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 0777U : 0U;
}

void write_text(const std::string& file, const std::string& text) {
  std::ofstream(file) << text;
}

TEST(Keys, TheDefaultFolderFollowsXdg) {
  EXPECT_EQ(default_key_folder("/x/config", "/home/a"), "/x/config/macula");
  EXPECT_EQ(default_key_folder(nullptr, "/home/a"), "/home/a/.config/macula");
  EXPECT_EQ(default_key_folder("", "/home/a"), "/home/a/.config/macula");
  EXPECT_EQ(default_key_folder("relative", "/home/a"), "/home/a/.config/macula");
}

TEST(Keys, AreMadeOnceAndPrivate) {
  TemporaryFolder base;
  const std::string folder = base.path() + "/deep/keys";
  const auto made = load_or_make_keys(folder, Role::Server);
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_TRUE(is_key(made->public_z85));
  EXPECT_EQ(mode_of(folder), 0700U);
  EXPECT_EQ(mode_of(folder + "/server.key"), 0600U);
  EXPECT_EQ(mode_of(folder + "/server.pub"), 0600U);
  const auto again = load_or_make_keys(folder, Role::Server);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->secret_z85, made->secret_z85);
  EXPECT_EQ(*load_public_key(folder + "/server.pub"), made->public_z85);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

TEST(Keys, ServerAndClientHaveTheirOwn) {
  TemporaryFolder folder;
  EXPECT_NE(load_or_make_keys(folder.path(), Role::Server)->public_z85,
            load_or_make_keys(folder.path(), Role::Client)->public_z85);
}

TEST(Keys, AFileThatOthersMayReadIsRefusedWithTheCommandThatMendsIt) {
  TemporaryFolder folder;
  ASSERT_TRUE(load_or_make_keys(folder.path(), Role::Client));
  const std::string file = folder.path() + "/client.key";
  ::chmod(file.c_str(), 0640);
  const auto loaded = load_or_make_keys(folder.path(), Role::Client);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().where, file);
  EXPECT_NE(loaded.error().remedy.find("chmod 600 '" + file + "'"), std::string::npos);
}

TEST(Keys, AFolderThatOthersMayEnterIsRefusedWithTheCommandThatMendsIt) {
  TemporaryFolder folder;
  ::chmod(folder.path().c_str(), 0755);
  const auto loaded = load_or_make_keys(folder.path(), Role::Client);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().remedy.find("chmod 700 '" + folder.path() + "'"), std::string::npos);
}

TEST(Keys, ADamagedKeyFileIsNamed) {
  TemporaryFolder folder;
  const std::string file = folder.path() + "/server.key";
  write_text(file, "not a key\n");
  ::chmod(file.c_str(), 0600);
  const auto loaded = load_or_make_keys(folder.path(), Role::Server);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().where, file);
  EXPECT_FALSE(load_public_key(folder.path() + "/missing.pub"));
}

TEST(Keys, ALostPublicFileComesBackFromTheSecretOne) {
  TemporaryFolder folder;
  const auto made = load_or_make_keys(folder.path(), Role::Client);
  fs::remove(folder.path() + "/client.pub");
  ASSERT_TRUE(load_or_make_keys(folder.path(), Role::Client));
  EXPECT_EQ(*load_public_key(folder.path() + "/client.pub"), made->public_z85);
}

TEST(Keys, TheAllowedFolderIsTheListOfClients) {
  TemporaryFolder folder;
  EXPECT_TRUE(allowed_clients(folder.path(), TrustOwnClient::Yes)->empty());
  const std::string key = make_key_pair().public_z85;
  ASSERT_TRUE(allow_client(folder.path(), "headset-1", key));
  EXPECT_EQ(mode_of(folder.path() + "/allowed"), 0700U);
  EXPECT_EQ(*allowed_clients(folder.path(), TrustOwnClient::No), std::vector<std::string>{key});
  const auto own = load_or_make_keys(folder.path(), Role::Client);
  EXPECT_EQ(*allowed_clients(folder.path(), TrustOwnClient::Yes),
            (std::vector<std::string>{own->public_z85, key}));
  write_text(folder.path() + "/allowed/damaged.pub", "x");
  write_text(folder.path() + "/allowed/note.txt", make_key_pair().public_z85);
  EXPECT_EQ(*allowed_clients(folder.path(), TrustOwnClient::No), std::vector<std::string>{key});
}

/// A crowd of connections once had every client expelled: the folder could not be opened, and that
/// was taken for a folder without keys.
TEST(Keys, WithoutADescriptorLeftItIsUnknownWhoIsAllowed) {
  TemporaryFolder folder;
  ASSERT_TRUE(allow_client(folder.path(), "headset-1", make_key_pair().public_z85));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int lowest_free = ::dup(STDOUT_FILENO);
  ::close(lowest_free);
  const rlimit none{static_cast<rlim_t>(lowest_free), before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto unknown = allowed_clients(folder.path(), TrustOwnClient::No);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_FALSE(unknown);
  EXPECT_EQ(allowed_clients(folder.path(), TrustOwnClient::No)->size(), 1U);
}

TEST(Keys, AClientsNameCannotLeaveTheFolder) {
  TemporaryFolder folder;
  const std::string key = make_key_pair().public_z85;
  for (const char* name : {"", ".", "..", "../up", "a/b", ".hidden", "white space"}) {
    EXPECT_FALSE(allow_client(folder.path(), name, key)) << name;
  }
  EXPECT_FALSE(allow_client(folder.path(), "fine", "too short"));
}

}  // namespace
}  // namespace macula::net
