// A null OpenXR runtime: a headset that exists only in a test. It does what a real one cannot be
// asked for: any rate, any eyes, an eye tracker, a session that ends or a runtime that dies at a
// given frame. A shared library that the loader takes through XR_RUNTIME_JSON; the test opens the
// same library and writes the script before the client starts. Its clock is CLOCK_MONOTONIC plus
// kTimeOffset_ns, so that whoever mixes the two is a million seconds off.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace macula::test {

inline constexpr std::int64_t kTimeOffset_ns = 1'000'000'000'000'000;

struct NullPose {
  float px = 0.0F, py = 0.0F, pz = 0.0F;
  float qx = 0.0F, qy = 0.0F, qz = 0.0F, qw = 1.0F;
};

/// Half-angles in radians, signed as OpenXR's.
struct NullFov {
  float left = -0.7F, right = 0.7F, up = 0.7F, down = -0.7F;
};

/// From one frame on; frames are counted from the session's first.
struct NullHead {
  std::uint64_t from_frame = 0;
  NullPose stage_from_head;
};
struct NullGaze {
  std::uint64_t from_frame = 0;
  bool tracked = true;
  NullPose head_from_gaze;  ///< looks along its -z
};

struct NullScript {
  double refresh_hz = 60.0;
  int width_px = 96, height_px = 80;  ///< recommended for an eye
  int most_px = 512;                  ///< allowed a side
  std::array<NullFov, 2> fov;         ///< left first
  std::array<NullPose, 2> head_from_eye{NullPose{-0.03F}, NullPose{0.03F}};
  std::vector<NullHead> heads{NullHead{}};
  std::vector<NullGaze> gazes;  ///< empty: a headset without a tracker
  bool offers_depth = true, offers_opengl = true, has_stage = true, has_headset = true;
  std::uint64_t hidden_frames = 1;  ///< at first shouldRender is false
  std::uint64_t stop_at_frame = 0;  ///< the runtime asks to stop; 0: never
  std::uint64_t lose_at_frame = 0;  ///< every call fails from there on; 0: never
  std::uint64_t capture_every = 0;  ///< keep the pictures of every Nth frame; 0: of none
};

/// What the client submitted.
struct NullFrame {
  std::uint64_t index = 0;
  std::int64_t predicted_display_ns = 0;  ///< CLOCK_MONOTONIC
  bool has_layer = false, has_depth = false;
  std::array<NullPose, 2> stage_from_eye;
  std::array<NullFov, 2> fov;
  float min_depth = 0.0F, max_depth = 0.0F, near_z = 0.0F, far_z = 0.0F;
  // Of captured frames, bottom row first, as OpenGL has them.
  int width_px = 0, height_px = 0;
  std::array<std::vector<std::uint8_t>, 2> rgba;
  std::array<std::vector<float>, 2> depth;
};

struct NullRuntime {
  std::mutex mutex;
  NullScript script;
  std::vector<NullFrame> frames;
  int misuses = 0;  ///< calls out of the order that the specification demands
  std::string first_misuse;
  int live_handles = 0;  ///< instances, sessions, spaces, swapchains, action sets
};

}  // namespace macula::test

extern "C" macula::test::NullRuntime* macula_null_runtime();
