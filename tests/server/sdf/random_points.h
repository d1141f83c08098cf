// Random numbers and points for tests of the distance room: the same in every run.
#pragma once

#include <cstdint>

#include "server/sdf/ball.h"
#include "shared/math/hash.h"

namespace macula::sdf {

class Uniform {
 public:
  /// In [-1, 1).
  float operator()() { return 2.0F * math::unit_float(math::hash_mix(state_++)) - 1.0F; }
  Vec3 in_ball(const Ball& ball) {
    for (;;) {
      const Vec3 v{(*this)(), (*this)(), (*this)()};
      if (glm::dot(v, v) < 1.0F) return ball.centre + ball.radius * v;
    }
  }

 private:
  std::uint64_t state_ = 11;
};

}  // namespace macula::sdf
