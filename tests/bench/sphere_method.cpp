#include "tests/bench/sphere_method.h"

#include <limits>

#include "shared/base/text.h"

namespace macula::bench {
namespace {

namespace sphere = kernels::sphere;

Result<sphere::Refresh> refresh_of(int frames) {
  if (frames == 1) return sphere::Refresh::EveryFrame;
  if (frames == 2) return sphere::Refresh::EverySecond;
  if (frames == 4) return sphere::Refresh::EveryFourth;
  return base::bad_input(base::concat("refresh is ", frames), "--refresh", "1, 2 or 4 frames");
}

Result<sphere::EdgeSource> edges_of(const std::string& name) {
  if (name == "depth") return sphere::EdgeSource::Depth;
  if (name == "albedo") return sphere::EdgeSource::Albedo;
  if (name == "shaded") return sphere::EdgeSource::Shaded;
  return base::bad_input(base::concat("unknown edges '", name, "'"), "--edges",
                         "depth, albedo or shaded");
}

Result<sphere::Config> foveated(const SphereCase& row) {
  sphere::Config config;
  const auto refresh = refresh_of(row.refresh);
  if (!refresh) return base::forward(refresh);
  const auto edges = edges_of(row.edges);
  if (!edges) return base::forward(edges);
  config.mask.fovea = Degrees{row.fovea_deg};
  config.mask.outer = Degrees{2.0 * row.fovea_deg};
  config.mask.edges = *edges;
  config.refresh = *refresh;
  if (row.method == "fipr") return config;
  config.mask.rule = sphere::MaskRule::Literal;
  config.mask.origin = sphere::AcuityOrigin::Gaze;
  config.mask.flat_share = 0.0F;
  config.detail = std::numeric_limits<float>::infinity();
  config.kept = sphere::Kept::InPlace;
  return config;
}

}  // namespace

Result<sphere::Config> sphere_config(const SphereCase& row) {
  sphere::Config config;
  config.foveation = sphere::Foveation::Off;
  if (row.foveated()) {
    const auto made = foveated(row);
    if (!made) return base::forward(made);
    config = *made;
  } else if (row.method == "full") {
    config.tracing = sphere::Tracing::Full;
  } else if (row.method == "full_best") {
    config.tracing = sphere::Tracing::FullBest;
  } else if (row.method == "ipr_paper") {
    config.tracing = sphere::Tracing::PaperPyramid;
  } else if (row.method != "ipr") {
    return base::bad_input(base::concat("unknown method '", row.method, "'"), "--methods",
                           "full, full_best, ipr_paper, ipr, fipr_paper or fipr");
  }
  config.samples_per_cell = row.samples;
  config.block_samples = sphere::block_samples_for(row.samples);
  return config;
}

}  // namespace macula::bench
