// The client program against a real OpenXR runtime: Monado, with its simulated headset and with one
// whose poses come over a socket. tests/support/monado/monado.sh prepare makes the folder it lives
// in; where that was not possible the tests skip by name.
#include <arpa/inet.h>
#include <fcntl.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "client/pose/trace.h"
#include "shared/image/png.h"
#include "tests/loopback/server_fixture.h"
#include "tests/support/measured_program.h"

namespace macula::loopback {
namespace {

const std::string kMonado = MACULA_MONADO_FOLDER;
const std::string kInside = MACULA_SOURCE_DIR "/tests/support/monado/monado.sh";

/// The remote headset's port is open to every network, so the tests have one of their own where
/// they may (as root); before any thread begins, for a thread keeps the network it began with.
bool leave_the_network() {
  if (unshare(CLONE_NEWNET) != 0) return false;
  const int any = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq loopback{};
  std::strncpy(loopback.ifr_name, "lo", IFNAMSIZ - 1);
  loopback.ifr_flags = IFF_UP | IFF_RUNNING;
  const bool up = ioctl(any, SIOCSIFFLAGS, &loopback) == 0;
  close(any);
  return up;
}
[[maybe_unused]] const bool left_the_network = leave_the_network();

/// A program in the background, with its own words in a file.
class Background {
 public:
  Background(std::vector<std::string> arguments, const std::string& log) {
    child_ = fork();
    if (child_ != 0) return;
    const int file = open(log.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    execv(words[0], words.data());
    _exit(127);
  }
  ~Background() { end(SIGTERM); }
  void end(int signal) {
    if (child_ <= 0) return;
    kill(child_, signal);
    for (int i = 0; i < 50; ++i) {
      if (waitpid(child_, nullptr, WNOHANG) == child_) {
        child_ = -1;
        return;
      }
      std::this_thread::sleep_for(100ms);
    }
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    child_ = -1;
  }

 private:
  pid_t child_ = -1;
};

/// A headset of Monado's driver `remote`: what is sent is where it is.
class RemoteHeadset {
 public:
  static constexpr int kPort = 4242;

  struct Eye {
    float left, right, up, down;
    std::array<float, 4> rotation;  ///< x, y, z, w
    std::array<float, 3> position;
    std::uint32_t unused = 0;
  };
  struct Packet {
    char magic[8] = {'m', 'n', 'd', 'r', 'm', 't', '3', '\0'};
    std::array<Eye, 2> eyes;
    std::array<float, 4> rotation{0, 0, 0, 1};
    std::array<float, 3> position{};
    std::uint8_t per_view_valid = 1, pad[3] = {};
    std::array<std::array<float, 30>, 2> controllers{};
  };
  static_assert(sizeof(Packet) == 376);

  /// Sends until destroyed; false from connected() where nobody listens.
  explicit RemoteHeadset(const Packet& packet) : packet_(packet) {
    socket_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(kPort);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
    if (connected_)
      sender_ = std::jthread([this](const std::stop_token& stop) { send_until(stop); });
  }
  ~RemoteHeadset() {
    sender_ = {};
    close(socket_);
  }
  bool connected() const { return connected_; }

 private:
  void send_until(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (send(socket_, &packet_, sizeof(packet_), MSG_NOSIGNAL) < 0) return;
      std::this_thread::sleep_for(10ms);
    }
  }

  const Packet packet_;
  int socket_ = -1;
  bool connected_ = false;
  std::jthread sender_;
};

enum class Driver { Simulated, Remote };

class Monado : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kMonado + "/ready"))
      GTEST_SKIP() << kMonado << " is not there: tests/support/monado/monado.sh prepare makes it";
    std::filesystem::create_directories(home_.path() + "/.config/monado");
    ::setenv("HOME", home_.path().c_str(), 1);
    ::setenv("XDG_RUNTIME_DIR", home_.path().c_str(), 1);
    ::setenv("XRT_NO_STDIN", "1", 1);
    ::setenv("XRT_COMPOSITOR_FORCE_XCB", "1", 1);
    ::unsetenv("XDG_CONFIG_HOME");
  }

  void start_service(Driver driver) {
    if (driver == Driver::Simulated) {
      ::setenv("SIMULATED_ENABLE", "1", 1);
    } else {
      ::unsetenv("SIMULATED_ENABLE");
      std::ofstream(home_.path() + "/.config/monado/config_v0.json")
          << R"({"active":"remote","remote":{"version":0,"port":4242,"view_count":2}})";
    }
    service_.emplace(
        std::vector<std::string>{kInside, "exec", kMonado, kMonado + "/usr/bin/monado-service"},
        log());
    for (int i = 0; i < 300; ++i) {
      if (std::filesystem::exists(home_.path() + "/monado_comp_ipc")) return;
      std::this_thread::sleep_for(100ms);
    }
    FAIL() << "Monado does not start: " << words();
  }
  test::MeasuredRun run_client(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        kInside,     "exec",       kMonado,     MACULA_CLIENT_PROGRAM,
        "--display", "openxr",     "--connect", server_->endpoint(),
        "--keys",    keys_.path(), "--size",    "120x120",
        "--record",  record(),     "--out",     out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_measured(arguments);
  }
  std::string log() const { return home_.path() + "/service.log"; }
  std::string record() const { return home_.path() + "/record.csv"; }
  std::string out() const { return home_.path() + "/out"; }
  std::string words() const {
    std::ostringstream text;
    text << std::ifstream(log()).rdbuf();
    return text.str();
  }

  TemporaryFolder home_, keys_;
  LoopbackServer server_{keys_.path()};
  std::optional<Background> service_;
};

TEST_F(Monado, ShowsThreeHundredFramesInItsSimulatedHeadset) {
  start_service(Driver::Simulated);
  if (HasFatalFailure()) return;
  const auto run = run_client({"--frames", "300"});
  ASSERT_EQ(run.status, 0) << run.output << words();
  EXPECT_NE(run.output.find("Monado"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("no eye tracker"), std::string::npos) << run.output;
  const auto trace = pose::load_trace(record());
  ASSERT_TRUE(trace) << trace.error().message();
  EXPECT_GE(trace->samples.size(), 300U);
  // It sways about (0, 1.6, 0): x from -15 to +5 cm, y by 5 cm.
  double least = 1e9, most = -1e9;
  for (const auto& sample : trace->samples) {
    const DVec3& at = sample.stage_from_head.position;
    EXPECT_NEAR(at.x, -0.05, 0.11);
    EXPECT_NEAR(at.y, 1.6, 0.06);
    least = std::min(least, at.x), most = std::max(most, at.x);
  }
  EXPECT_GT(most - least, 0.02);
  const auto left = image::read_png(out() + "/eye_left.png");
  const auto right = image::read_png(out() + "/eye_right.png");
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->width(), 120);
  EXPECT_FALSE(std::ranges::equal(left->pixels(), right->pixels()));
}

TEST_F(Monado, PublishesThePosesThatWereScripted) {
  start_service(Driver::Remote);
  if (HasFatalFailure()) return;
  RemoteHeadset::Packet packet;
  packet.position = {0.25F, 1.5F, 0.75F};
  packet.rotation = {0.0F, std::sin(0.2F), 0.0F, std::cos(0.2F)};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    packet.eyes[eye] = {-0.9F, 0.7F, 0.8F, -0.6F, {0, 0, 0, 1}, {eye == 0 ? -0.03F : 0.03F, 0, 0}};
  }
  std::swap(packet.eyes[1].left, packet.eyes[1].right);
  packet.eyes[1].left *= -1.0F, packet.eyes[1].right *= -1.0F;
  const RemoteHeadset headset(packet);
  ASSERT_TRUE(headset.connected()) << words();
  const auto run = run_client({"--frames", "60"});
  ASSERT_EQ(run.status, 0) << run.output << words();
  const auto trace = pose::load_trace(record());
  ASSERT_TRUE(trace) << trace.error().message();
  const auto& settled = trace->samples.back().stage_from_head;
  EXPECT_LT(glm::length(settled.position - DVec3(0.25, 1.5, 0.75)), 1e-4);
  EXPECT_NEAR(settled.rotation.y, std::sin(0.2), 1e-4);
  EXPECT_NEAR(settled.rotation.w, std::cos(0.2), 1e-4);
}

TEST_F(Monado, ItsDeathEndsTheClientWithASentence) {
  start_service(Driver::Simulated);
  if (HasFatalFailure()) return;
  // Once the client has something to record, it shows frames.
  const std::jthread killer([this] {
    for (int i = 0; i < 600; ++i) {
      std::error_code none;
      if (std::filesystem::file_size(record(), none) > 0 && !none) break;
      std::this_thread::sleep_for(100ms);
    }
    std::this_thread::sleep_for(1s);
    service_->end(SIGKILL);
  });
  const auto run = run_client({});
  EXPECT_EQ(run.status, 1) << run.output;
  EXPECT_NE(run.output.find("the OpenXR runtime went away"), std::string::npos) << run.output;
  EXPECT_TRUE(std::filesystem::exists(out() + "/report.json"));
}

}  // namespace
}  // namespace macula::loopback
