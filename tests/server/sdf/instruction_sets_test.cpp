// What processors without 512-bit vectors see: the same pictures, up to roundings of fused
// multiply-adds and of roots.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>

#include "tests/server/sdf/tracing.h"

namespace macula::sdf {
namespace {

constexpr double kMostRelativeSquare = 1e-4;  // of pictures by different instruction sets
constexpr double kMostOtherStatus = 1e-3;     // rays that graze a surface

struct Likeness {
  double relative_square = 0.0;  ///< mean of ((a - b) / a)^2 over rays that hit in both
  double other_status = 0.0;     ///< share of rays that hit in one only
  double other_place = 0.0;      ///< share of hits farther apart than 1e-4 of t
};
Likeness likeness(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  Likeness sum;
  double both = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum.other_status += a[i].status != b[i].status;
    if (a[i].status != RayStatus::Hit || b[i].status != RayStatus::Hit) continue;
    const double apart = (a[i].t - b[i].t) / a[i].t;
    sum.relative_square += apart * apart, sum.other_place += std::abs(apart) > 1e-4, both += 1.0;
  }
  const double hits = std::max(both, 1.0);
  return {sum.relative_square / hits, sum.other_status / static_cast<double>(a.size()),
          sum.other_place / hits};
}

std::vector<Hit> picture(const Program& program, const Pose& pose, Method method) {
  TraceOptions options;
  options.method = method;
  return trace_picture(program, pose, ordinary_grid(80, 60), options).hits;
}

class InstructionSets : public testing::TestWithParam<const char*> {};

TEST_P(InstructionSets, AllMeetTheSameSurfaces) {
  const Field field = built_in(GetParam());
  const Pose pose = field.pose_of(field.cameras.front(), 1.0);
  const Program program = compile(field, 1.0, pose.position);
  for (const Method method : {Method::Full, Method::Cones}) {
    const std::vector<Hit> best = picture(program, pose, method);
    int sets = 0;
    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1, ++sets) {
      const std::int64_t target = rest & -rest;
      SCOPED_TRACE(hwy::TargetName(target));
      hwy::SetSupportedTargetsForTest(target);
      const Likeness like = likeness(best, picture(program, pose, method));
      hwy::SetSupportedTargetsForTest(0);
      EXPECT_LE(like.relative_square, kMostRelativeSquare);
      EXPECT_LE(like.other_status, kMostOtherStatus);
      EXPECT_LE(like.other_place, 2e-3);
    }
    EXPECT_GE(sets, 2);
    // A hand's breadth aside is another picture.
    const Program aside = compile(field, 1.0, pose.position + DVec3{0.1, 0.0, 0.0});
    const Likeness other = likeness(best, picture(aside, pose, method));
    EXPECT_GT(other.relative_square, kMostRelativeSquare);
    EXPECT_GT(other.other_place, 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Sdf, InstructionSets, testing::Values("primitives", "columns", "temple"));

}  // namespace
}  // namespace macula::sdf
