#include "server/kernels/lightcuts/retinal_speed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace macula::kernels::lightcuts {
namespace {

/// An eye that looks along its own -Z.
struct Eye {
  Vec3 position;
  Mat3 retina_from_world;

  explicit Eye(const View& view) : position(view.world_from_view.position) {
    const auto head = glm::mat3_cast(view.world_from_view.rotation);
    const auto gaze = glm::mat3_cast(glm::quat(Vec3(0.0F, 0.0F, -1.0F), view.gaze.direction));
    retina_from_world = glm::transpose(Mat3(head) * Mat3(gaze));
  }
  Vec3 towards(const Vec3& point) const { return retina_from_world * (point - position); }
};

float degrees_between(const Vec3& a, const Vec3& b) {
  constexpr float kDegrees = 180.0F / std::numbers::pi_v<float>;
  return kDegrees * std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

class Speeds {
 public:
  Speeds(const Passage& passage, const ViewSurfaces& surfaces,
         const Plane<std::uint32_t>& surface_id)
      : passage_(passage),
        surfaces_(surfaces),
        surface_id_(surface_id),
        then_(passage.then),
        now_(passage.now),
        world_from_view_(glm::mat3_cast(passage.now.world_from_view.rotation)) {
    for (const scene::InstanceMotion& motion : passage.motions)
      before_from_now_.push_back(glm::inverse(motion.now_from_before));
  }

  float at(int x, int y) const {
    const SurfaceAt surface = surfaces_.at(x, y);
    float degrees = 0.0F;
    if (surface) {
      const Vec3 position = surface.position();
      degrees = degrees_between(then_.towards(before(position, surface_id_(x, y))),
                                now_.towards(position));
    } else {
      const Vec3 direction = world_from_view_ * passage_.now.grid.ray(x, y);
      degrees =
          degrees_between(then_.retina_from_world * direction, now_.retina_from_world * direction);
    }
    return degrees / static_cast<float>(passage_.seconds);
  }

 private:
  Vec3 before(const Vec3& position, std::uint32_t id) const {
    if (id == 0) return position;
    const auto found =
        std::ranges::lower_bound(passage_.motions, id - 1, {}, &scene::InstanceMotion::instance);
    if (found == passage_.motions.end() || found->instance != id - 1) return position;
    const auto which = static_cast<std::size_t>(found - passage_.motions.begin());
    return Vec3(before_from_now_[which] * glm::dvec4(position, 1.0));
  }

  const Passage& passage_;
  const ViewSurfaces& surfaces_;
  const Plane<std::uint32_t>& surface_id_;
  Eye then_, now_;
  Mat3 world_from_view_;
  std::vector<DMat4> before_from_now_;
};

}  // namespace

Plane<float> retinal_speed(const Passage& passage, const ViewSurfaces& surfaces,
                           const Plane<std::uint32_t>& surface_id, TileScheduler& scheduler) {
  Plane<float> speed(surfaces.width, surfaces.height);
  const Speeds speeds(passage, surfaces, surface_id);
  scheduler.run(static_cast<std::size_t>(speed.height()), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < speed.width(); ++x) speed(x, y) = speeds.at(x, y);
  });
  return speed;
}

}  // namespace macula::kernels::lightcuts
