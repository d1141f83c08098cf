// Every kernel, in both modes, at the edges of what is possible: each input has a defined picture,
// and a near miss that the comparison must tell from it.
#include "shared/base/text.h"
#include "tests/stability/extreme.h"

namespace macula::stability {
namespace {

struct Case {
  std::string kernel;
  kernels::Mode mode;
  Extreme extreme;

  std::string name() const {
    return base::concat(kernel, mode == kernels::Mode::Exact ? "_exact_" : "_fast_", extreme.name);
  }
};

std::vector<Case> cases_of(const std::vector<Extreme>& extremes, kernels::SceneKind kind) {
  std::vector<Case> cases;
  for (const Extreme& extreme : extremes) {
    for (const auto& entry : kernels::kernel_table()) {
      if (!kernels::renders(entry, kind)) continue;
      const std::string kernel(entry.name);
      cases.push_back({kernel, kernels::Mode::Exact, extreme});
      if (extreme.in == In::BothModes && kernel != "brute")
        cases.push_back({kernel, kernels::Mode::Fast, extreme});
    }
  }
  return cases;
}

double tolerance(kernels::Mode mode, const Extreme& extreme) {
  return extreme.relative_mse + (mode == kernels::Mode::Fast ? extreme.noise : 0.0);
}
bool looks_the_same(const Difference& found, kernels::Mode mode, const Extreme& extreme) {
  return found.finite && found.relative_mse <= tolerance(mode, extreme) &&
         found.strange_depths <= extreme.strange_depths;
}

class Extremes : public testing::TestWithParam<Case> {};

TEST_P(Extremes, ShowTheirDefinedPictureAndNoOther) {
  const auto& [kernel, mode, extreme] = GetParam();
  const Picture plain = show(kernel, mode, extreme.plain());
  const Difference found =
      difference(plain, show(kernel, mode, extreme.extreme()), extreme.depth_error);
  EXPECT_TRUE(looks_the_same(found, mode, extreme))
      << "finite " << found.finite << ", relative MSE " << found.relative_mse << " (at most "
      << tolerance(mode, extreme) << "), strange depths " << found.strange_depths;
  const Difference missed =
      difference(plain, show(kernel, mode, extreme.near_miss()), extreme.depth_error);
  EXPECT_FALSE(looks_the_same(missed, mode, extreme))
      << "a near miss passes: relative MSE " << missed.relative_mse;
  RecordProperty("relative_mse", base::concat(found.relative_mse));
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return info.param.name();
}
std::vector<Case> on_triangles(const std::vector<Extreme>& extremes) {
  return cases_of(extremes, kernels::SceneKind::Triangles);
}
INSTANTIATE_TEST_SUITE_P(Places, Extremes, testing::ValuesIn(on_triangles(places())), name_of);
INSTANTIATE_TEST_SUITE_P(Views, Extremes, testing::ValuesIn(on_triangles(views())), name_of);
INSTANTIATE_TEST_SUITE_P(Lights, Extremes, testing::ValuesIn(on_triangles(lights())), name_of);
INSTANTIATE_TEST_SUITE_P(Surfaces, Extremes, testing::ValuesIn(on_triangles(surfaces())), name_of);
INSTANTIATE_TEST_SUITE_P(Fields, Extremes,
                         testing::ValuesIn(cases_of(fields(), kernels::SceneKind::Field)), name_of);

}  // namespace
}  // namespace macula::stability
