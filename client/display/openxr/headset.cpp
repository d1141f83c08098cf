#include "client/display/openxr/headset.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "client/display/gl/textures.h"
#include "client/display/openxr/eye_gaze.h"
#include "client/display/openxr/runtime.h"
#include "client/display/openxr/session.h"
#include "client/display/openxr/swapchain.h"
#include "client/display/openxr/xr_values.h"
#include "shared/base/check.h"
#include "shared/base/log.h"

namespace macula::display {
namespace {

using namespace std::chrono_literals;

constexpr auto kPollPause = 5ms;
constexpr auto kFirstFramePatience = 10s;
constexpr auto kExitPatience = 2s;

/// Depth is sent as near / z: 1 at `kNear_m`, 0 at infinity, which the layer calls farZ and nearZ.
constexpr float kNear_m = 0.05F;

PictureSize chosen_size(const HeadsetOptions& options, const Runtime& runtime) {
  const PictureSize wanted = options.eye_px.value_or(runtime.recommended_px());
  const PictureSize most = runtime.largest_px();
  return {std::min(wanted.width_px, most.width_px), std::min(wanted.height_px, most.height_px)};
}

/// One eye's textures.
struct EyeTextures {
  std::unique_ptr<Swapchain> color, depth;  ///< depth: null where the runtime takes none
};

Result<EyeTextures> make_textures(const Runtime& runtime, const Session& session,
                                  PictureSize size) {
  EyeTextures textures;
  auto color = Swapchain::create(session.handle(), Swapchain::Kind::Color, size);
  if (!color) return base::forward(color);
  textures.color = std::move(*color);
  if (!runtime.takes_depth()) return textures;
  auto depth = Swapchain::create(session.handle(), Swapchain::Kind::Depth, size);
  if (!depth) return base::forward(depth);
  textures.depth = std::move(*depth);
  return textures;
}

/// The projection layer and what it points to.
struct Layer {
  std::array<XrCompositionLayerDepthInfoKHR, 2> depths;
  std::array<XrCompositionLayerProjectionView, 2> views;
  XrCompositionLayerProjection projection;
};

}  // namespace

struct Headset::Parts {
  std::unique_ptr<Runtime> runtime;
  std::unique_ptr<Session> session;
  std::unique_ptr<EyeGaze> gaze;  ///< null: no tracker
  std::array<EyeTextures, 2> textures;
  PictureSize eye_px;
  double refresh_hz = 0.0;
  HeadsetEyes first_eyes;
  TextureFiller filler;
  image::Plane<float> depth;  ///< as the layer has it
  bool in_frame = false;

  void make_gaze();
  Result<void> wait_for_first_frame();
  bool fill(const EyeTextures& eye, const HeadsetPicture& picture);
  bool fill_depth(Swapchain& swapchain, const image::Plane<float>& inverse_depth_per_m);
  void describe(const HeadsetEyes& eyes, std::span<const HeadsetPicture> pictures, Layer& layer);
};

/// A headset without a tracker, or one whose tracker is denied, is still a headset.
void Headset::Parts::make_gaze() {
  if (!runtime->tracks_gaze()) return;
  auto made = EyeGaze::create(*runtime, session->handle());
  if (made) {
    gaze = std::move(*made);
  } else {
    base::log_warning("no gaze: " + made.error().message());
  }
}

/// A runtime's first frames are often not to be drawn; they tell its rate and the eyes.
Result<void> Headset::Parts::wait_for_first_frame() {
  const auto give_up = std::chrono::steady_clock::now() + kFirstFramePatience;
  while (std::chrono::steady_clock::now() < give_up) {
    const HeadsetState state = session->poll();
    if (state == HeadsetState::Lost || state == HeadsetState::Closed) break;
    const auto frame =
        state == HeadsetState::Running ? session->begin_frame() : std::optional<HeadsetFrame>();
    if (!frame) {
      std::this_thread::sleep_for(kPollPause);
      continue;
    }
    const auto eyes = session->eyes(frame->display);
    session->end_frame({});
    if (!eyes || frame->period <= Nanoseconds{0}) continue;
    refresh_hz = 1.0 / units::to_s(frame->period);
    first_eyes = *eyes;
    return {};
  }
  return base::runtime_error("the runtime asked for no frame and knows no eyes",
                             runtime->description(),
                             "put the headset on, or wake its runtime; without one use --display "
                             "window");
}

Result<std::unique_ptr<Headset>> Headset::create(const HeadsetOptions& options) {
  auto parts = std::make_unique<Parts>();
  auto runtime = Runtime::create();
  if (!runtime) return base::forward(runtime);
  parts->runtime = std::move(*runtime);
  auto session = Session::create(*parts->runtime);
  if (!session) return base::forward(session);
  parts->session = std::move(*session);
  parts->make_gaze();
  parts->eye_px = chosen_size(options, *parts->runtime);
  for (EyeTextures& eye : parts->textures) {
    auto textures = make_textures(*parts->runtime, *parts->session, parts->eye_px);
    if (!textures) return base::forward(textures);
    eye = std::move(*textures);
  }
  if (auto done = parts->wait_for_first_frame(); !done) return base::forward(done);
  return std::unique_ptr<Headset>(new Headset(std::move(parts)));
}

Headset::Headset(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Headset::~Headset() {
  if (parts_->in_frame) end_frame({}, {});
  HeadsetState state = poll();
  if (state == HeadsetState::Running) request_exit();
  const auto give_up = std::chrono::steady_clock::now() + kExitPatience;
  while ((state = poll()) == HeadsetState::Running && std::chrono::steady_clock::now() < give_up) {
    // A runtime may need frames to go on until it says stop.
    if (begin_frame()) end_frame({}, {});
  }
}

const std::string& Headset::description() const {
  return parts_->runtime->description();
}
PictureSize Headset::eye_px() const {
  return parts_->eye_px;
}
bool Headset::tracks_gaze() const {
  return parts_->gaze != nullptr;
}
bool Headset::takes_depth() const {
  return parts_->runtime->takes_depth();
}
double Headset::refresh_hz() const {
  return parts_->refresh_hz;
}
const HeadsetEyes& Headset::first_eyes() const {
  return parts_->first_eyes;
}
HeadsetState Headset::poll() {
  return parts_->session->poll();
}
std::optional<Pose> Headset::stage_from_head(ClientTime at) {
  return parts_->session->stage_from_head(at);
}
std::optional<HeadsetEyes> Headset::eyes(ClientTime at) {
  return parts_->session->eyes(at);
}
void Headset::request_exit() {
  parts_->session->request_exit();
}

std::optional<HeadsetFrame> Headset::begin_frame() {
  MACULA_CHECK(!parts_->in_frame, "the frame before was not ended");
  auto frame = parts_->session->begin_frame();
  parts_->in_frame = frame.has_value();
  return frame;
}

HeadsetGaze Headset::gaze(ClientTime at) {
  const auto sample =
      parts_->gaze ? parts_->gaze->sample(parts_->session->head(), at) : std::nullopt;
  if (!sample) return {{.valid = false, .confidence = 0.0F}, at};
  return {{.direction = sample->direction}, sample->at};
}

bool Headset::Parts::fill(const EyeTextures& eye, const HeadsetPicture& picture) {
  MACULA_CHECK(
      picture.color.width() == eye_px.width_px && picture.color.height() == eye_px.height_px,
      "a picture has the size of an eye");
  const auto texture = eye.color->acquire();
  if (!texture) return false;
  filler.fill(*texture, picture.color);
  eye.color->release();
  if (!eye.depth || picture.inverse_depth_per_m.empty()) return true;
  return fill_depth(*eye.depth, picture.inverse_depth_per_m);
}

bool Headset::Parts::fill_depth(Swapchain& swapchain,
                                const image::Plane<float>& inverse_depth_per_m) {
  const auto texture = swapchain.acquire();
  if (!texture) return false;
  if (depth.size() != inverse_depth_per_m.size())
    depth.resize(inverse_depth_per_m.width(), inverse_depth_per_m.height());
  std::transform(inverse_depth_per_m.pixels().begin(), inverse_depth_per_m.pixels().end(),
                 depth.pixels().begin(),
                 [](float inverse) { return std::clamp(kNear_m * inverse, 0.0F, 1.0F); });
  filler.fill_depth(*texture, depth);
  swapchain.release();
  return true;
}

void Headset::Parts::describe(const HeadsetEyes& eyes, std::span<const HeadsetPicture> pictures,
                              Layer& layer) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    layer.views[i] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr,
                      to_xr(eyes[i].stage_from_eye), to_xr(eyes[i].fov),
                      textures[i].color->whole()};
    if (!textures[i].depth || pictures[i].inverse_depth_per_m.empty()) continue;
    layer.depths[i] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR,
                       nullptr,
                       textures[i].depth->whole(),
                       0.0F,
                       1.0F,
                       kInfinity,
                       kNear_m};
    layer.views[i].next = &layer.depths[i];
  }
  layer.projection = {
      XR_TYPE_COMPOSITION_LAYER_PROJECTION,           nullptr,           0, session->stage(),
      static_cast<std::uint32_t>(layer.views.size()), layer.views.data()};
}

void Headset::end_frame(const HeadsetEyes& eyes, std::span<const HeadsetPicture> pictures) {
  MACULA_CHECK(parts_->in_frame, "no frame was begun");
  MACULA_CHECK(pictures.empty() || pictures.size() == eyes.size(), "one picture an eye");
  parts_->in_frame = false;
  bool filled = !pictures.empty();
  for (std::size_t i = 0; i < pictures.size() && filled; ++i)
    filled = parts_->fill(parts_->textures[i], pictures[i]);
  if (!filled) return parts_->session->end_frame({});
  Layer layer;
  parts_->describe(eyes, pictures, layer);
  const std::array layers{reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer.projection)};
  parts_->session->end_frame(layers);
}

}  // namespace macula::display
