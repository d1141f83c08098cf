// The wire's messages as plain structs; protobuf types stop inside this room (wire.cpp).
// Everything a frame was made with travels in its FrameBegin.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/foveation/gaze.h"
#include "shared/foveation/pixel_grid.h"
#include "shared/image/plane.h"
#include "shared/image/tone.h"
#include "shared/math/fov.h"
#include "shared/math/pose.h"
#include "shared/units/time.h"

namespace macula::net {

inline constexpr std::uint32_t kProtocolVersion = 1;

/// Ability of clients that decode and draw layer 1 of frames.
inline constexpr const char* kHiddenLayerAbility = "hidden_layer";

using ResumeToken = std::array<std::byte, 16>;

struct Settings {
  std::uint32_t generation = 0;
  std::string color_codec{};        ///< "jpeg", "h264", "lossless", "" = the server's default
  int jpeg_quality = 0;             ///< 1..100, 0 = the server's default
  std::string rate_model{};         ///< a preset's name, "" = the server's default
  double fovea_oversampling = 0.0;  ///< 1, 1.5, 2, ...; 0 = the server's default
};

struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::string program;
  std::vector<foveation::Display> eyes;  ///< 1 or 2
  double refresh_hz = 72.0;
  std::vector<std::string> codecs;
  std::vector<std::string> abilities;
  std::optional<ResumeToken> resume_token;
  Settings settings;
};

struct SceneSummary {
  std::string name;
  std::uint64_t triangles = 0, lights = 0;
  Pose scene_from_stage;
};

struct Welcome {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint64_t session = 0;
  std::uint32_t epoch = 0;
  ResumeToken resume_token{};
  std::string color_codec, kernel;
  std::uint32_t frame_window = 2;
  std::uint32_t max_part_bytes = 65536;
  SceneSummary scene;
  std::vector<std::string> abilities;
};

enum class RefusalCode { Unspecified, VersionMismatch, UnknownSession, BadRequest, ServerFull };
struct Refusal {
  RefusalCode code = RefusalCode::Unspecified;
  std::string text;  ///< a sentence that says what to do
};

struct Bye {
  std::string reason;
  std::uint32_t retry_after_ms = 0;
};

struct EyeState {
  Pose head_from_eye;
  Fov fov;
  Gaze gaze;
};

/// What the client has. `received` counts a frame fully received or discarded; 0 = none yet.
struct Acks {
  std::uint32_t epoch = 0;
  std::uint64_t received = 0;
  std::uint64_t receiving = 0;
  std::uint64_t receiving_bytes = 0;
  bool need_key = false;     ///< a frame was lost that later ones lean on
  Nanoseconds least_rtt{0};  ///< of Pings lately; 0: not known yet
};

struct ViewState {
  std::uint64_t sequence = 0;
  ClientTime sampled{};  ///< when the head pose was read
  ClientTime predicted_display{};
  Pose stage_from_head;
  std::vector<EyeState> eyes;  ///< as many as Hello announced
  ClientTime gaze_sampled{};
  Acks acks;  ///< filled in by ClientEndpoint
};

struct FrameView {
  Pose stage_from_view;  ///< as rendered
  Fov display_fov;
  Gaze gaze;
  PixelGrid grid;
  /// On the wire only: the grid is left out, it is the one this earlier frame carried for this eye.
  std::uint64_t grid_frame = 0;
  image::Tone tone;
  float depth_inverse_scale_per_m = 0.0F;    ///< a depth sample of 65535 means this inverse depth
  std::vector<std::uint8_t> depth_residual;  ///< per 8x8 block; see codec::DepthPlane
  float hidden_depth_inverse_scale_per_m = 0.0F;  ///< the same of layer 1
};

enum class PlaneKind : std::uint8_t { Color, Depth, Mask };
enum class SliceCodec : std::uint8_t { Jpeg, Lossless, H264, InverseDepth, BandMask };

/// One entry of the slice directory. The payload travels in parts of at most max_part_bytes. Layer
/// 0 is what is seen. Layer 1, what that hides around silhouettes, comes whole or not at all: its
/// mask, then its colours, an atlas of the mask's tiles at (0, 0), then its depth.
struct SliceEntry {
  std::uint32_t eye = 0, layer = 0;
  PlaneKind plane = PlaneKind::Color;
  SliceCodec codec = SliceCodec::Jpeg;
  image::Rect rect;  ///< in cells of the eye's grid; colour of layer 1: of the atlas
  std::uint32_t size_bytes = 0;
};

struct InstanceMotion {
  std::uint32_t instance = 0;
  Pose stage_from_before;
};

/// What the server's governor chose for a frame.
struct FrameQuality {
  double scale = 1.0;                    ///< of the periphery's resolution, (0, 1]
  int depth_divisor = 1;                 ///< one depth sample for so many cells each way
  std::uint64_t color_budget_bytes = 0;  ///< 0: not bounded
  bool stateless_color = false;          ///< no frame leans on another: the link loses too many
  double kernel = 10.0;                  ///< on the kernel's own ladder, 0 to 10; 10: the best
};

struct FrameBegin {
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;  ///< counts from 1 within an epoch
  std::uint64_t view_sequence = 0;
  ClientTime view_sampled{}, view_predicted_display{}, gaze_sampled{};
  Nanoseconds horizon{0};  ///< how far ahead of the view state the pose was predicted
  Radians guard_band{0.0};
  double view_cell_m = 0.0;  ///< how far eyes may move for layer 1 to hold; 0: no such layer
  FrameQuality quality;
  std::vector<FrameView> views;
  std::string kernel, config;
  std::uint64_t seed = 0;
  std::vector<SliceEntry> slices;
  bool is_key = true;                 ///< leans on no other frame
  std::uint64_t reference_frame = 0;  ///< otherwise on this one, which must have been decoded
  std::vector<InstanceMotion> motions;
  Nanoseconds scene_time{0};  ///< what moves is shown at this moment of the scene's clock
  std::uint32_t settings_generation = 0;
  std::uint64_t previous_frame = 0;  ///< 0 = none; the two stamps below are that frame's send_queue
  ServerTime previous_send_begin{}, previous_send_end{};
};

struct FrameEnd {
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  ServerTime view_received{};  ///< when the net thread woke for the view state
  ServerTime render_begin{}, render_end{}, encode_begin{}, encode_end{};
  std::uint64_t rays = 0, cells = 0;
  std::uint64_t hidden_cells = 0;  ///< of layer 1
};

using Payload = std::shared_ptr<const std::vector<std::byte>>;

/// A whole encoded frame: payloads[i] belongs to begin.slices[i].
struct EncodedFrame {
  FrameBegin begin;
  std::vector<Payload> payloads;
  FrameEnd end;
};

struct Ping {
  std::uint64_t sequence = 0;
  ClientTime sent{};
};
struct Pong {
  std::uint64_t sequence = 0;
  ClientTime ping_sent{};
  ServerTime ping_received{}, pong_sent{};
};
struct Beat {
  std::uint64_t sequence = 0;
  ServerTime sent{};
};
struct SliceHeader {
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  std::uint32_t slice = 0;
  std::uint32_t offset_bytes = 0;
};

using Message = std::variant<Hello, Welcome, Refusal, Settings, Bye, ViewState, Acks, FrameBegin,
                             SliceHeader, FrameEnd, Ping, Pong, Beat>;

/// What is refused before anything is allocated.
struct Limits {
  std::size_t max_part_bytes = 65536;       ///< payload parts
  std::size_t max_envelope_bytes = 262144;  ///< part 0 (grids make FrameBegin the largest)
  std::size_t max_view_state_bytes = 512;
  std::size_t max_frame_bytes = 64U << 20;
  std::size_t max_slices = 256;
  int max_views = 2;
  int max_side_px = 8192;
  std::size_t max_cells = 32U << 20;  ///< over all views of a frame
};

}  // namespace macula::net
