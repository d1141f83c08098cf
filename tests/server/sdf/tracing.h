// What the tests of the distance room share: scenes from text, and whole pictures traced in tiles.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/sdf/read.h"
#include "server/sdf/tracer.h"
#include "shared/math/fov.h"

namespace macula::sdf {

inline Field field_of(const std::string& text) {
  const Result<Field> field = parse_field(text, "test");
  if (!field) ADD_FAILURE() << field.error().message();
  return field.value();
}
/// A scene of one node.
inline Field scene_of(const std::string& node) {
  return field_of("{\"far\": 1000, \"scene\": " + node + "}");
}

/// One of the scenes that come with the program.
inline Field built_in(std::string_view name) {
  for (const BuiltInField& each : built_in_fields()) {
    if (each.name == name) return field_of(std::string(each.text));
  }
  ADD_FAILURE() << "no scene is called " << name;
  return {};
}

inline PixelGrid ordinary_grid(int width, int height, Degrees vertical_fov = Degrees{60.0}) {
  const double aspect = static_cast<double>(width) / height;
  return foveation::make_uniform_grid({math::symmetric_fov(vertical_fov, aspect), width, height});
}

/// How many rays, points or pairs a test sends: as many as it usually does, or MACULA_SDF_RAYS.
inline int many(int usual) {
  const char* const asked = std::getenv("MACULA_SDF_RAYS");
  return asked == nullptr ? usual : std::max(usual, std::atoi(asked));
}
/// At least so many cells, four wide for three high.
inline PixelGrid grid_of(int cells, Degrees vertical_fov = Degrees{60.0}) {
  const int height = static_cast<int>(std::ceil(std::sqrt(0.75 * cells)));
  return ordinary_grid((cells + height - 1) / height, height, vertical_fov);
}

struct Traced {
  std::vector<Hit> hits;  ///< row by row, a cell's samples in order
  TraceCounts counts;
};

inline Traced trace_picture(const Program& program, const Pose& pose, const PixelGrid& grid,
                            const TraceOptions& options, int tile_side = kTileSide) {
  const Result<Tracer> tracer =
      Tracer::create(program, glm::mat3_cast(pose.rotation), grid, options);
  if (!tracer) ADD_FAILURE() << tracer.error().message();
  Traced result;
  const auto samples = static_cast<std::size_t>(options.samples);
  const auto width = static_cast<std::size_t>(grid.width());
  result.hits.resize(width * static_cast<std::size_t>(grid.height()) * samples);
  TraceWorkspace workspace;
  for (int y = 0; y < grid.height(); y += tile_side) {
    for (int x = 0; x < grid.width(); x += tile_side) {
      const image::Rect tile{x, y, std::min(tile_side, grid.width() - x),
                             std::min(tile_side, grid.height() - y)};
      result.counts += tracer->trace(tile, nullptr, workspace, [&](const HitBlock& block) {
        for (const Hit& hit : block.hits)
          result.hits[(hit.y * width + hit.x) * samples + hit.sample] = hit;
      });
    }
  }
  return result;
}

/// The number of hits with other bits: status, place, normal or material.
inline std::size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differ += a[i].status != b[i].status || a[i].t != b[i].t || a[i].normal != b[i].normal ||
              a[i].material != b[i].material;
  }
  return differ;
}

}  // namespace macula::sdf
