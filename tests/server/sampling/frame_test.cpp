#include "server/sampling/frame.h"

#include <gtest/gtest.h>

#include "server/sampling/mappings.h"
#include "server/sampling/sample.h"

namespace macula::sampling {
namespace {

/// Largest entry of F^T F - 1, and the handedness.
double defect(const Mat3& frame) {
  const DMat3 f(frame);
  const DMat3 product = glm::transpose(f) * f;
  double worst = std::abs(glm::dot(glm::cross(f[0], f[1]), f[2]) - 1.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      worst = std::max(worst, std::abs(product[i][j] - (i == j ? 1.0 : 0.0)));
  return worst;
}

TEST(Frame, IsRightHandedAndOrthonormalForEveryNormal) {
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 normal =
        uniform_sphere(sample_2d(SampleKey(1, 0, static_cast<std::uint64_t>(i)), 0));
    const Mat3 frame = frame_from_normal(normal);
    ASSERT_LT(defect(frame), 2e-6);
    ASSERT_EQ(frame[2], normal);
  }
}

TEST(Frame, HoldsAtThePolesAndRightBesideThem) {
  EXPECT_LT(defect(frame_from_normal({0.0F, 0.0F, 1.0F})), 1e-7);
  EXPECT_LT(defect(frame_from_normal({0.0F, 0.0F, -1.0F})), 1e-7);
  EXPECT_LT(defect(frame_from_normal({1.0F, 0.0F, -0.0F})), 1e-7);
  // Frisvad's original construction divides by 1 + z and loses everything here.
  for (const float tilt : {1e-3F, 1e-4F, 1e-5F, 1e-7F}) {
    EXPECT_LT(defect(frame_from_normal(glm::normalize(Vec3{tilt, -tilt, -1.0F}))), 1e-6) << tilt;
  }
}

}  // namespace
}  // namespace macula::sampling
