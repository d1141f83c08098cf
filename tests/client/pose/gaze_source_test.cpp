#include "client/pose/gaze_source.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <cmath>

#include "client/pose/interactive_source.h"
#include "client/pose/udp_gaze.h"

namespace macula::pose {
namespace {

using namespace std::chrono_literals;

const Fov kFov{Radians{-0.7}, Radians{0.7}, Radians{0.5}, Radians{-0.5}};

TEST(TargetGaze, StaysOnThePointWhateverTheHeadDoes) {
  TargetGaze gaze;
  for (int i = 0; i < 50; ++i) {
    const Nanoseconds since = i * 100ms;
    Pose head{DVec3{0.3 * i, 1.5, 0.1 * i}, glm::angleAxis(0.1 * i, DVec3{0.0, 1.0, 0.0})};
    const GazeSample sample = gaze.sample(ClientTime{5s + since}, head);
    const DVec3 towards = glm::normalize(TargetGaze::target(since) - head.position);
    const DVec3 looks = head.transform_direction(DVec3(sample.gaze.direction));
    EXPECT_LT(glm::length(looks - towards), 1e-6) << i;
    EXPECT_TRUE(sample.gaze.valid);
  }
}

TEST(TargetGaze, WandersFortyDegreesAcross) {
  const DVec3 leftmost = TargetGaze::target(6s), rightmost = TargetGaze::target(2s);
  EXPECT_NEAR(std::atan2(rightmost.x, -rightmost.z), Radians(Degrees{20.0}).value(), 1e-9);
  EXPECT_NEAR(std::atan2(leftmost.x, -leftmost.z), -Radians(Degrees{20.0}).value(), 1e-9);
}

TEST(HeadWithGaze, TakesTheHeadFromOneAndTheGazeFromTheOther) {
  Steering one_meter_right, looking_right;
  one_meter_right.move_m = {1.0, 0.0, 0.0};
  looking_right.gaze_tangent = DVec2{0.5, 0.0};
  auto head = std::make_unique<InteractiveSource>(), mouse = std::make_unique<InteractiveSource>();
  head->steer(one_meter_right);
  mouse->steer(looking_right);
  HeadWithGaze both(std::move(head), std::make_unique<GazeOfHead>(std::move(mouse)));
  const auto sample = both.sample(ClientTime{1s});
  ASSERT_TRUE(sample);
  EXPECT_DOUBLE_EQ(sample->stage_from_head.position.x, 1.0);
  EXPECT_NEAR(sample->gaze.direction.x / -sample->gaze.direction.z, 0.5F, 1e-6F);
}

TEST(GazePacket, IsADirectionOrAPlaceInThePicture) {
  const auto direction = parse_gaze_packet(R"({"direction":[3,0,-4],"age_ms":4})", kFov);
  ASSERT_TRUE(direction) << direction.error().message();
  EXPECT_FLOAT_EQ(direction->gaze.direction.x, 0.6F);
  EXPECT_EQ(direction->age, 4ms);
  const auto corner = parse_gaze_packet(R"({"picture":[1,0],"confidence":0.5})", kFov);
  ASSERT_TRUE(corner) << corner.error().message();
  const Vec3 looks = corner->gaze.direction;
  EXPECT_NEAR(looks.x / -looks.z, std::tan(0.7), 1e-6);
  EXPECT_NEAR(looks.y / -looks.z, std::tan(0.5), 1e-6);
  EXPECT_EQ(corner->gaze.confidence, 0.5F);
  const auto blink = parse_gaze_packet(R"({"valid":false,"tracker":"any"})", kFov);
  ASSERT_TRUE(blink) << blink.error().message();
  EXPECT_FALSE(blink->gaze.valid);
}

TEST(GazePacket, SaysWhatIsWrongWithIt) {
  for (const auto& [text, word] : std::vector<std::pair<const char*, const char*>>{
           {"", "no JSON object"},
           {"[1,2]", "no JSON object"},
           {"{}", "neither direction nor picture"},
           {R"({"direction":[1,2]})", "3 numbers"},
           {R"({"direction":[1,2,"x"]})", "3 numbers"},
           {R"({"direction":[0,0,0]})", "no length"},
           {R"({"picture":[0.5,1e999]})", "no JSON object"},
           {R"({"picture":[0.5,0.5],"age_ms":-1})", "age_ms"},
           {R"({"picture":[0.5,0.5],"confidence":2})", "confidence"},
           {R"({"picture":[0.5,0.5],"valid":1})", "valid"}}) {
    const auto packet = parse_gaze_packet(text, kFov);
    ASSERT_FALSE(packet) << text;
    EXPECT_NE(packet.error().message().find(word), std::string::npos) << packet.error().message();
  }
}

class UdpGazeTest : public testing::Test {
 protected:
  void SetUp() override {
    auto gaze = UdpGaze::create("127.0.0.1:0", kFov, clock_);
    ASSERT_TRUE(gaze) << gaze.error().message();
    gaze_ = std::move(*gaze);
    clock_.advance(10s);
  }
  void send(const std::string& text) {
    const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(gaze_->port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::sendto(socket, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof(to));
    ::close(socket);
  }
  GazeSample sample() { return gaze_->sample(ClientTime{clock_.now()}, Pose{}); }

  base::ManualClock clock_;
  std::unique_ptr<UdpGaze> gaze_;
};

TEST_F(UdpGazeTest, TheNewestPacketWinsAndItsAgeCounts) {
  EXPECT_FALSE(sample().gaze.valid);
  send(R"({"direction":[0,0,-1]})");
  send(R"({"direction":[1,0,-1],"age_ms":5})");
  send("not a gaze");
  const GazeSample newest = sample();
  EXPECT_TRUE(newest.gaze.valid);
  EXPECT_GT(newest.gaze.direction.x, 0.5F);
  EXPECT_EQ(ClientTime{clock_.now()} - newest.at, 5ms);
}

TEST_F(UdpGazeTest, AGazeThatIsNotRenewedIsLost) {
  send(R"({"direction":[0,0,-1]})");
  EXPECT_TRUE(sample().gaze.valid);
  clock_.advance(201ms);
  EXPECT_FALSE(sample().gaze.valid);
}

TEST_F(UdpGazeTest, NamesAnAddressThatItCannotHave) {
  for (const char* address : {"", "localhost:1", "127.0.0.1", "127.0.0.1:99999", "8.8.8.8:7790"}) {
    const auto gaze = UdpGaze::create(address, kFov, clock_);
    ASSERT_FALSE(gaze) << address;
    EXPECT_EQ(gaze.error().exit_status(), 2);
  }
}

}  // namespace
}  // namespace macula::pose
