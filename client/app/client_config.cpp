#include "client/app/client_config.h"

#include "shared/base/text.h"

namespace macula::client_app {
namespace {

const char* name(DisplayKind kind) {
  return kind == DisplayKind::Window ? "window" : "headless";
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
  return config.display == DisplayKind::Window ? "(mouse and keys)" : "(demo trace)";
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
      return {.detail_px = WarpOptions::kGridDetail_px, .filter = WarpOptions::Filter::Bilinear};
    case ClientConfig::Warp::Rotation:
      return {.method = WarpOptions::Method::RotationOnly};
    case ClientConfig::Warp::Stale:
      return {.method = WarpOptions::Method::Stale};
  }
  return {};
}

foveation::Display eye_display(const ClientConfig& config) {
  const double aspect = static_cast<double>(config.width_px) / config.height_px;
  return {math::symmetric_fov(config.vertical_fov, aspect), config.width_px, config.height_px};
}

net::Hello make_hello(const ClientConfig& config) {
  net::Hello hello;
  hello.program = "macula-client";
  hello.eyes.assign(static_cast<std::size_t>(config.eyes), eye_display(config));
  hello.refresh_hz = config.refresh_hz;
  hello.codecs = {"jpeg", "lossless"};
  hello.settings = config.settings;
  return hello;
}

std::vector<std::pair<std::string, std::string>> describe(const ClientConfig& config) {
  const auto& wish = config.settings;
  return {
      {"connect", config.connect},
      {"display", name(config.display)},
      {"size_px", base::concat(config.width_px, "x", config.height_px)},
      {"fov_deg", base::concat(config.vertical_fov.value())},
      {"eyes", base::concat(config.eyes)},
      {"ipd_mm", base::concat(1e3 * config.ipd.value())},
      {"refresh_hz", base::concat(config.refresh_hz)},
      {"pacing", config.pacing == Pacing::RealTime ? "real time" : "as fast as possible"},
      {"trace", pose_source_name(config)},
      {"repeat", config.repeat_trace == ClientConfig::Repeat::Yes ? "yes" : "no"},
      {"frames", config.frames == 0 ? "(until the poses end)" : base::concat(config.frames)},
      {"reprojection", name(config.warp)},
      {"codec", or_server_default(wish.color_codec)},
      {"oversampling",
       or_server_default(wish.fovea_oversampling == 0.0 ? ""
                                                        : base::concat(wish.fovea_oversampling))},
      {"rate_model", or_server_default(wish.rate_model)},
      {"out", config.out_folder.empty() ? "(none)" : config.out_folder},
  };
}

}  // namespace macula::client_app
