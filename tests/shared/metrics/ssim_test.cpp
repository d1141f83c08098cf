#include "shared/metrics/ssim.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "shared/metrics/error.h"
#include "tests/shared/metrics/formula_images.h"

namespace macula::metrics {
namespace {

using test::picture;
using test::rnd;
using test::texture_at;

Plane<float> texture() {
  return picture([](int x, int y) { return static_cast<float>(texture_at(x, y)); });
}
/// change(value, x, y) applied to every pixel of the texture.
template <class Change>
Plane<float> texture_with(Change change) {
  return picture([&](int x, int y) { return static_cast<float>(change(texture_at(x, y), x, y)); });
}
Plane<float> flat(float value) {
  return picture([value](int, int) { return value; });
}
int noisy(int value, int x, int y) {
  const double noise = 40.0 * (rnd(static_cast<std::uint32_t>(y * test::kFormulaWidth + x)) - 0.5);
  return value + static_cast<int>(std::lround(noise));
}
double mean_square(const Plane<float>& a, const Plane<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a.data()[i] - b.data()[i], 2);
  return sum / static_cast<double>(a.size());
}

struct KnownPair {
  const char* name;
  Plane<float> reference, test;
  double ssim, mse, psnr_db;
};

// Values of 8-bit pictures computed with an independent implementation of Wang et al. (2004).
TEST(Ssim, HasTheKnownAnswersOfFormulaPictures) {
  const KnownPair pairs[] = {
      {"black and white", flat(0), flat(255), 0.00009999, 65025.0, 0.0},
      {"two greys", flat(100), flat(120), 0.98361092, 400.0, 22.110204},
      {"brighter", texture(), texture_with([](int v, int, int) { return v + 10; }), 0.99709376,
       100.0, 28.130804},
      {"noise", texture(), texture_with(noisy), 0.91874881, 136.83138, 26.768947},
      {"negative", texture(), texture_with([](int v, int, int) { return 255 - v; }), -0.90226567,
       3547.2266, 12.631914},
  };
  for (const KnownPair& pair : pairs) {
    SCOPED_TRACE(pair.name);
    EXPECT_NEAR(ssim(pair.reference, pair.test, 255.0), pair.ssim, 1e-6);
    const double error = mean_square(pair.reference, pair.test);
    EXPECT_NEAR(error, pair.mse, 1e-4 * std::max(1.0, pair.mse));
    EXPECT_NEAR(db_from_mse(error, 255.0), pair.psnr_db, 1e-5);
  }
}

// Without variance the structure term is 1: (2ab + C1) / (a^2 + b^2 + C1).
TEST(Ssim, OfTwoConstantsIsTheLuminanceTermAlone) {
  const double c1 = 6.5025, expected = (2 * 100 * 120 + c1) / (100 * 100 + 120 * 120 + c1);
  EXPECT_NEAR(ssim(flat(100), flat(120), 255.0), expected, 1e-7);
}

TEST(Ssim, DoesNotDependOnTheScaleWhenThePeakFollows) {
  const auto to_unit = [](const Plane<float>& in) {
    return picture([&](int x, int y) { return in(x, y) / 255.0F; });
  };
  const auto noise = texture_with(noisy);
  EXPECT_NEAR(ssim(to_unit(texture()), to_unit(noise), 1.0), ssim(texture(), noise, 255.0), 1e-6);
  // The trap: constants of one scale with values of another hide nearly every difference.
  EXPECT_GT(ssim(to_unit(texture()), to_unit(noise), 255.0), 0.999);
}

TEST(Ssim, IsOneForIdenticalPicturesAndSymmetric) {
  const auto noise = texture_with(noisy);
  EXPECT_NEAR(ssim(noise, noise, 255.0), 1.0, 1e-7);
  EXPECT_EQ(ssim(texture(), noise, 255.0), ssim(noise, texture(), 255.0));
}

TEST(Ssim, CountsOnlyWindowsThatFit) {
  const auto map = ssim_map(texture(), texture(), 255.0);
  EXPECT_EQ(map.width(), test::kFormulaWidth - 10);
  EXPECT_EQ(map.height(), test::kFormulaHeight - 10);
}

TEST(Ssim, OfGreyPicturesIsTheSameByLumaAndByChannel) {
  const auto grey = [](const Plane<float>& in) {
    return picture([&](int x, int y) { return Rgb{in(x, y) / 255.0F}; });
  };
  const auto r = grey(texture()), t = grey(texture_with(noisy));
  EXPECT_NEAR(ssim_luma(r, t), 0.91874881, 1e-5);
  EXPECT_NEAR(ssim_rgb(r, t), 0.91874881, 1e-5);
}

}  // namespace
}  // namespace macula::metrics
