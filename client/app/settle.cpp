#include "client/app/settle.h"

#include <algorithm>

namespace macula::client_app {

double settled_share(Nanoseconds age) {
  const double t = std::clamp(units::to_s(age - kSettleAfter) / units::to_s(kSettleTime), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Pose settled_pose(const Pose& stage_from_display, const Pose& stage_from_frame, double share) {
  return {glm::mix(stage_from_display.position, stage_from_frame.position, share),
          stage_from_display.rotation};
}

void draw_vignette(image::Plane<Rgb8>& picture, double share) {
  if (share <= 0.0) return;
  constexpr int kWhole = 256;  // of a colour's weight, in fixed point
  const auto squares = [](int count) {
    std::vector<int> values;  // 0 in the middle, kWhole at both ends
    for (int i = 0; i < count; ++i) {
      const double off = (2.0 * i + 1.0 - count) / count;
      values.push_back(static_cast<int>(kWhole * off * off));
    }
    return values;
  };
  const std::vector<int> across = squares(picture.width()), down = squares(picture.height());
  const int depth = static_cast<int>(kWhole * share) / 4;  // two sides make a half
  for (int y = 0; y < picture.height(); ++y) {
    const auto row = picture.row(y);
    for (int x = 0; x < picture.width(); ++x) {
      const int weight = kWhole - depth * (across[x] + down[y]) / kWhole;
      Rgb8& c = row[x];
      c = {static_cast<std::uint8_t>(c.r * weight / kWhole),
           static_cast<std::uint8_t>(c.g * weight / kWhole),
           static_cast<std::uint8_t>(c.b * weight / kWhole)};
    }
  }
}

}  // namespace macula::client_app
