#include "shared/net/wire.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/shared/net/random_messages.h"

namespace macula::net {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// Encoding is a pure function of the fields, so equal bytes after a round trip mean equal fields.
template <class T>
void expect_round_trip(const T& message) {
  const std::string sent = encode_envelope(message);
  const auto back = decode_envelope(bytes_of(sent));
  ASSERT_TRUE(back) << back.error().message();
  ASSERT_TRUE(std::holds_alternative<T>(*back));
  EXPECT_EQ(encode_envelope(*back), sent);
}

TEST(Wire, EveryMessageSurvivesTheRoundTrip) {
  RandomMessages random(1);
  for (int i = 0; i < 50; ++i) {
    for (const Message& message : random.one_of_each()) {
      std::visit([](const auto& m) { expect_round_trip(m); }, message);
    }
  }
}

TEST(Wire, FieldsComeBackWhereTheyWere) {
  RandomMessages random(2);
  const auto sent = random.view_state();
  const auto back = decode_envelope(bytes_of(encode_envelope(sent)));
  ASSERT_TRUE(back);
  const auto& view = std::get<ViewState>(*back);
  EXPECT_EQ(view.sequence, sent.sequence);
  EXPECT_EQ(view.sampled, sent.sampled);
  EXPECT_EQ(view.predicted_display, sent.predicted_display);
  EXPECT_EQ(view.gaze_sampled, sent.gaze_sampled);
  EXPECT_EQ(view.stage_from_head.position, sent.stage_from_head.position);
  EXPECT_EQ(view.stage_from_head.rotation, sent.stage_from_head.rotation);
  ASSERT_EQ(view.eyes.size(), 2U);
  EXPECT_EQ(view.eyes[1].fov.left, sent.eyes[1].fov.left);
  EXPECT_EQ(view.eyes[1].fov.down, sent.eyes[1].fov.down);
  EXPECT_EQ(view.eyes[1].gaze.direction, sent.eyes[1].gaze.direction);
  EXPECT_EQ(view.acks.receiving_bytes, sent.acks.receiving_bytes);
}

TEST(Wire, AViewStateOfTwoEyesFitsInto512Bytes) {
  RandomMessages random(3);
  for (int i = 0; i < 1000; ++i) EXPECT_LE(encode_envelope(random.view_state()).size(), 512U);
}

TEST(Wire, PingAndPongStayBelow100Bytes) {
  RandomMessages random(4);
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(encode_envelope(random.ping()).size(), 100U);
    EXPECT_LT(encode_envelope(random.pong()).size(), 100U);
  }
}

// 1e4 damaged envelopes: cut short, bits flipped, or both. None may crash, and whatever decodes
// must encode again (its values are in range).
TEST(Wire, DamagedEnvelopesNeverCrash) {
  RandomMessages random(5);
  std::mt19937_64 chance(6);
  int refused = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto messages = random.one_of_each();
    std::string bytes = encode_envelope(messages[chance() % messages.size()]);
    if (chance() % 2 == 0) bytes.resize(chance() % (bytes.size() + 1));
    for (std::size_t flips = chance() % 8; flips > 0 && !bytes.empty(); --flips) {
      bytes[chance() % bytes.size()] ^= static_cast<char>(1U << (chance() % 8U));
    }
    const auto decoded = decode_envelope(bytes_of(bytes));
    if (decoded) {
      encode_envelope(*decoded);
    } else {
      ++refused;
      EXPECT_FALSE(decoded.error().what.empty());
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Wire, AnotherVersionIsNamedTogetherWithOurs) {
  std::string bytes = encode_envelope(Ping{1, {}});
  bytes[3] = 9;
  EXPECT_EQ(wire_version(bytes_of(bytes)), 9);
  const auto decoded = decode_envelope(bytes_of(bytes));
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().what.find("version 9"), std::string::npos);
  EXPECT_NE(decoded.error().what.find(std::to_string(kProtocolVersion)), std::string::npos);
}

TEST(Wire, ForeignBytesAreNoEnvelope) {
  EXPECT_EQ(wire_version(bytes_of("GET / HTTP/1.1")), std::nullopt);
  EXPECT_EQ(wire_version(bytes_of("MA")), std::nullopt);
  EXPECT_FALSE(decode_envelope(bytes_of("GET / HTTP/1.1")));
}

TEST(Wire, AHelloOfAnotherVersionStillTellsItsVersion) {
  RandomMessages random(7);
  Hello hello = random.hello();
  hello.protocol_version = 2;
  hello.eyes.clear();
  const auto decoded = decode_envelope(bytes_of(encode_envelope(hello)));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<Hello>(*decoded).protocol_version, 2U);
}

template <class Spoil>
bool view_is_refused(Spoil&& spoil) {
  RandomMessages random(8);
  ViewState view = random.view_state();
  EXPECT_TRUE(check_view_state(view));
  spoil(view);
  return !check_view_state(view);
}

TEST(Wire, ViewStatesThatCannotBeRenderedAreRefused) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.stage_from_head.position.x = kNaN; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.stage_from_head.position.y = kInfinity; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.stage_from_head.position.z = 1e30; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.stage_from_head.rotation.w += 0.5; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.stage_from_head.rotation = {0, 0, 0, 0}; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes[0].head_from_eye.position.x = kNaN; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes[1].fov = {}; }));
  EXPECT_TRUE(view_is_refused(
      [](ViewState& v) { v.eyes[0].fov = math::symmetric_fov(Degrees{180.0}, 1.0); }));
  EXPECT_TRUE(
      view_is_refused([](ViewState& v) { std::swap(v.eyes[0].fov.left, v.eyes[0].fov.right); }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes[1].gaze.direction.x += 0.5F; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes[1].gaze.confidence = 2.0F; }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes.clear(); }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) { v.eyes.resize(3, v.eyes[0]); }));
  EXPECT_TRUE(view_is_refused([](ViewState& v) {
    v.sampled = ClientTime{Nanoseconds{std::numeric_limits<std::int64_t>::min()}};
  }));
}

TEST(Wire, AGazeOffScreenIsLegal) {
  EXPECT_FALSE(view_is_refused([](ViewState& v) {
    v.eyes[0].gaze.direction = {1.0F, 0.0F, 0.0F};
  }));
}

/// The error of a FrameBegin spoiled so, decoded from its bytes; empty when it was taken.
template <class Spoil>
std::string refusal_of(Spoil&& spoil, const Limits& limits = {}) {
  RandomMessages random(9);
  FrameBegin begin = random.frame_begin();
  spoil(begin);
  const auto decoded = decode_envelope(bytes_of(encode_envelope(begin)), limits);
  return decoded ? std::string{} : decoded.error().message();
}

TEST(Wire, FrameBeginsBeyondTheLimitsAreRefusedByName) {
  EXPECT_EQ(refusal_of([](FrameBegin&) {}), "");
  const auto names = [](const std::string& text, const char* field) {
    return text.find(field) != std::string::npos;
  };
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.frame = 0; }), "frame_begin.frame"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.views.clear(); }), "views"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.views.resize(3, b.views[0]); }), "views"));
  EXPECT_TRUE(
      names(refusal_of([](FrameBegin& b) { b.slices.resize(257, b.slices[0]); }), "slices"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.slices[0].rect.width = 1 << 20; }), "rect"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.slices[0].rect.x = 60; }), "rect"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.slices[0].rect.height = 0; }), "rect"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.slices[0].eye = 2; }), "slices[0]"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.slices[0].size_bytes = 0; }), "size_bytes"));
  EXPECT_TRUE(
      names(refusal_of([](FrameBegin& b) { b.slices[0].plane = PlaneKind::Depth; }), "slices[0]"));
  EXPECT_TRUE(
      names(refusal_of([](FrameBegin& b) { b.slices[0].size_bytes = 0xFFFFFFFFU; }), "at most"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) {
                      std::swap(b.views[0].grid.x_edges[3], b.views[0].grid.x_edges[4]);
                    }),
                    "grid"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.views[0].grid.y_edges = {0.0F}; }), "grid"));
  EXPECT_TRUE(
      names(refusal_of([](FrameBegin& b) { b.views[1].depth_residual.resize(5); }), "residual"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.views[0].stage_from_view.rotation.x = NAN; }),
                    "stage_from_view"));
  EXPECT_TRUE(
      names(refusal_of([](FrameBegin& b) { b.views[0].tone.exposure_ev = INFINITY; }), "exposure"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.views[0].depth_inverse_scale_per_m = NAN; }),
                    "depth"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.guard_band = Radians{-1.0}; }), "guard_band"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) { b.view_cell_m = NAN; }), "view_cell"));
  EXPECT_TRUE(names(refusal_of([](FrameBegin& b) {
                      b.slices[0].plane = PlaneKind::Mask;  // of a codec of colour or depth
                    }),
                    "plane"));
}

// An atlas is made of whole tiles of 16 cells; the grid's last row of tiles reaches over its edge.
TEST(Wire, AnAtlasLiesWithinWholeTilesOfItsGrid) {
  const auto refuses = [](const image::Rect& rect, std::uint32_t layer) {
    return !refusal_of([&](FrameBegin& b) {
              b.slices[0].layer = layer;
              b.slices[0].rect = rect;
            }).empty();
  };
  EXPECT_FALSE(refuses({0, 0, 48, 48}, 1));
  EXPECT_TRUE(refuses({0, 0, 48, 48}, 0)) << "a picture of 48 x 36 cells";
  EXPECT_TRUE(refuses({0, 0, 64, 48}, 1));
  EXPECT_TRUE(refuses({0, 0, 48, 49}, 1));
  EXPECT_TRUE(refuses({0, 0, 48, 0}, 1));
}

TEST(Wire, TheDirectorysSumIsHeldToTheFrameLimit) {
  Limits limits;
  limits.max_frame_bytes = 10'000;
  const auto sizes = [](std::uint32_t each) {
    return [each](FrameBegin& begin) {
      for (SliceEntry& slice : begin.slices) slice.size_bytes = each;
    };
  };
  RandomMessages random(9);
  const auto slices = static_cast<std::uint32_t>(random.frame_begin().slices.size());
  EXPECT_EQ(refusal_of(sizes(10'000 / slices), limits), "");
  EXPECT_NE(refusal_of(sizes(10'000 / slices + 1), limits), "");
}

TEST(Wire, EnvelopesAboveTheLimitAreRefused) {
  Limits limits;
  limits.max_envelope_bytes = 1000;
  EXPECT_FALSE(decode_envelope(bytes_of(encode_envelope(Bye{std::string(2000, 'x'), 0})), limits));
  limits.max_view_state_bytes = 100;
  RandomMessages random(10);
  EXPECT_FALSE(decode_envelope(bytes_of(encode_envelope(random.view_state())), limits));
}

}  // namespace
}  // namespace macula::net
