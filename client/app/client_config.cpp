#include "client/app/client_config.h"

#include "shared/base/text.h"
#include "shared/codec/h264.h"

namespace macula::client_app {
namespace {

const char* name(DisplayKind kind) {
  switch (kind) {
    case DisplayKind::Headless:
      return "headless";
    case DisplayKind::Window:
      return "window";
    case DisplayKind::OpenXr:
      return "openxr";
  }
  return "?";
}

const char* name(ClientConfig::Warp warp) {
  using Warp = ClientConfig::Warp;
  switch (warp) {
    case Warp::Mesh:
      return "mesh";
    case Warp::Grid:
      return "grid";
    case Warp::Rotation:
      return "rotation";
    case Warp::Stale:
      return "stale";
  }
  return "?";
}

std::string pose_source_name(const ClientConfig& config) {
  if (!config.trace_file.empty()) return config.trace_file;
  switch (config.display) {
    case DisplayKind::Headless:
      return "(demo trace)";
    case DisplayKind::Window:
      return "(mouse and keys)";
    case DisplayKind::OpenXr:
      return "(headset)";
  }
  return "?";
}

std::string gaze_source_name(const ClientConfig& config) {
  using GazeFrom = ClientConfig::GazeFrom;
  switch (config.gaze) {
    case GazeFrom::Head:
      return "(with the head)";
    case GazeFrom::Mouse:
      return "mouse";
    case GazeFrom::Target:
      return "target";
    case GazeFrom::Udp:
      return "udp://" + config.gaze_address;
  }
  return "?";
}

std::string or_server_default(const std::string& wish) {
  return wish.empty() ? "(server's default)" : wish;
}

}  // namespace

reprojection::WarpOptions warp_options(ClientConfig::Warp warp) {
  using reprojection::WarpOptions;
  switch (warp) {
    case ClientConfig::Warp::Mesh:
      break;
    case ClientConfig::Warp::Grid:
      return WarpOptions::grid_mode();
    case ClientConfig::Warp::Rotation:
      return {.method = WarpOptions::Method::RotationOnly};
    case ClientConfig::Warp::Stale:
      return {.method = WarpOptions::Method::Stale};
  }
  return {};
}

EyeRig eye_rig(const ClientConfig& config) {
  const double aspect = static_cast<double>(config.width_px) / config.height_px;
  return EyeRig::side_by_side(
      {math::symmetric_fov(config.vertical_fov, aspect), config.width_px, config.height_px},
      config.eyes, config.ipd, config.convergence);
}

net::Hello make_hello(const ClientConfig& config, const EyeRig& rig, double refresh_hz) {
  net::Hello hello;
  hello.program = "macula-client";
  for (const EyeRig::Eye& eye : rig.eyes) hello.eyes.push_back(eye.display);
  hello.refresh_hz = refresh_hz;
  hello.codecs = {"jpeg", "lossless"};
  if (codec::can_decode_h264()) hello.codecs.insert(hello.codecs.begin(), "h264");
  if (config.warp != ClientConfig::Warp::Rotation && config.warp != ClientConfig::Warp::Stale) {
    hello.abilities = {net::kHiddenLayerAbility};
  }
  hello.settings = config.settings;
  return hello;
}

std::vector<std::pair<std::string, std::string>> describe(const ClientConfig& config) {
  const auto& wish = config.settings;
  const bool headset = config.display == DisplayKind::OpenXr;
  const auto unless_headset = [&](std::string value) {
    return headset ? "(headset's)" : std::move(value);
  };
  return {
      {"connect", config.connect},
      {"display", name(config.display)},
      {"size_px",
       config.width_px > 0 ? base::concat(config.width_px, "x", config.height_px) : "(headset's)"},
      {"fov_deg", unless_headset(base::concat(config.vertical_fov.value()))},
      {"eyes", unless_headset(base::concat(config.eyes))},
      {"ipd_mm", unless_headset(base::concat(1e3 * config.ipd.value()))},
      {"refresh_hz", unless_headset(base::concat(config.refresh_hz))},
      {"pacing", config.pacing == Pacing::RealTime ? "real time" : "as fast as possible"},
      {"trace", pose_source_name(config)},
      {"gaze", gaze_source_name(config)},
      {"repeat", config.repeat_trace == ClientConfig::Repeat::Yes ? "yes" : "no"},
      {"frames", config.frames == 0 ? "(until the poses end)" : base::concat(config.frames)},
      {"reprojection", name(config.warp)},
      {"warp_on", config.warp_on == ClientConfig::WarpOn::Gl ? "gl" : "cpu"},
      {"codec", or_server_default(wish.color_codec)},
      {"oversampling",
       or_server_default(wish.fovea_oversampling == 0.0 ? ""
                                                        : base::concat(wish.fovea_oversampling))},
      {"rate_model", or_server_default(wish.rate_model)},
      {"out", config.out_folder.empty() ? "(none)" : config.out_folder},
  };
}

}  // namespace macula::client_app
