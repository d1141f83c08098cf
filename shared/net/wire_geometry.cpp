#include <macula/v1/geometry.pb.h>

#include "shared/base/text.h"
#include "shared/net/wire_parts.h"

namespace macula::net::wire {

void write(const Pose& pose, v1::Pose& out) {
  out.set_px_m(pose.position.x);
  out.set_py_m(pose.position.y);
  out.set_pz_m(pose.position.z);
  out.set_qx(pose.rotation.x);
  out.set_qy(pose.rotation.y);
  out.set_qz(pose.rotation.z);
  out.set_qw(pose.rotation.w);
}

Pose read(const v1::Pose& in) {
  return {DVec3(in.px_m(), in.py_m(), in.pz_m()), DQuat(in.qw(), in.qx(), in.qy(), in.qz())};
}

void write(const Fov& fov, v1::Fov& out) {
  out.set_left_rad(fov.left.value());
  out.set_right_rad(fov.right.value());
  out.set_up_rad(fov.up.value());
  out.set_down_rad(fov.down.value());
}

Fov read(const v1::Fov& in) {
  return {Radians{in.left_rad()}, Radians{in.right_rad()}, Radians{in.up_rad()},
          Radians{in.down_rad()}};
}

void write(const Gaze& gaze, v1::Gaze& out) {
  out.set_x(gaze.direction.x);
  out.set_y(gaze.direction.y);
  out.set_z(gaze.direction.z);
  out.set_valid(gaze.valid);
  out.set_confidence(gaze.confidence);
}

Gaze read(const v1::Gaze& in) {
  return {Vec3(in.x(), in.y(), in.z()), in.valid(), in.confidence()};
}

void write(const PixelGrid& grid, v1::PixelGrid& out) {
  out.mutable_x_edges_tan()->Add(grid.x_edges.begin(), grid.x_edges.end());
  out.mutable_y_edges_tan()->Add(grid.y_edges.begin(), grid.y_edges.end());
}

PixelGrid read(const v1::PixelGrid& in) {
  return {{in.x_edges_tan().begin(), in.x_edges_tan().end()},
          {in.y_edges_tan().begin(), in.y_edges_tan().end()}};
}

void write(const image::Tone& tone, v1::Tone& out) {
  out.set_exposure_ev(tone.exposure_ev);
  out.set_curve(tone.curve == image::ToneCurve::Filmic ? v1::Tone::CURVE_FILMIC
                                                       : v1::Tone::CURVE_LINEAR);
}

Result<image::Tone> read(const v1::Tone& in) {
  switch (in.curve()) {
    case v1::Tone::CURVE_LINEAR:
      return image::Tone{in.exposure_ev(), image::ToneCurve::Linear};
    case v1::Tone::CURVE_FILMIC:
      return image::Tone{in.exposure_ev(), image::ToneCurve::Filmic};
    default:
      return base::bad_input(base::concat("unknown tone curve ", static_cast<int>(in.curve())),
                             "tone.curve");
  }
}

void write(const image::Rect& rect, v1::Rect& out) {
  out.set_x_px(static_cast<std::uint32_t>(rect.x));
  out.set_y_px(static_cast<std::uint32_t>(rect.y));
  out.set_width_px(static_cast<std::uint32_t>(rect.width));
  out.set_height_px(static_cast<std::uint32_t>(rect.height));
}

Result<image::Rect> read(const v1::Rect& in) {
  constexpr std::uint32_t kMost_px = 1U << 20;
  for (const std::uint32_t value : {in.x_px(), in.y_px(), in.width_px(), in.height_px()}) {
    if (value > kMost_px) {
      return base::bad_input(base::concat(value, " px"), "rect",
                             base::concat("at most ", kMost_px));
    }
  }
  return image::Rect{static_cast<int>(in.x_px()), static_cast<int>(in.y_px()),
                     static_cast<int>(in.width_px()), static_cast<int>(in.height_px())};
}

}  // namespace macula::net::wire
