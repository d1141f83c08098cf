#include "server/kernels/ray/resampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace macula::kernels::ray {
namespace {

class Scores {
 public:
  explicit Scores(const ResamplingJob& job)
      : job_(job), columns_(job.support.x.count()), rows_(job.support.y.count()) {}

  Plane<float> run() {
    const bool printed = job_.config.resampling == ResamplingRule::Neighbours;
    samples_ = Plane<float>(columns_, rows_);
    if (printed) {
      score_neighbours();
    } else {
      score_contradictions();
    }
    if (printed || job_.motion == Motion::Moving) score_grazing();
    return of_quads();
  }

 private:
  int cell_x(int i) const { return job_.support.x.cells[i]; }
  int cell_y(int j) const { return job_.support.y.cells[j]; }

  /// New against remembered luminance, its mean over 3 x 3 samples: a single sample differs by
  /// chance, a wrong memory does so in one direction.
  void score_contradictions() {
    Plane<float> difference(columns_, rows_);
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const float remembered = job_.luminance.remembered(i, j);
        if (remembered >= 0.0F) difference(i, j) = job_.luminance.fresh(i, j) - remembered;
      }
    }
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        raise(i, j, std::abs(mean_around(difference, i, j)) / job_.config.luminance_threshold);
      }
    }
  }
  float mean_around(const Plane<float>& plane, int i, int j) const {
    float sum = 0.0F;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        sum += plane(std::clamp(i + di, 0, columns_ - 1), std::clamp(j + dj, 0, rows_ - 1));
      }
    }
    return sum / 9.0F;
  }

  /// As printed: the reprojected picture against its own direct neighbours.
  void score_neighbours() {
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        if (i + 1 < columns_) compare(i, j, i + 1, j);
        if (j + 1 < rows_) compare(i, j, i, j + 1);
      }
    }
  }
  void compare(int i, int j, int k, int l) {
    const Plane<float>& remembered = job_.luminance.remembered;
    const float here = remembered(i, j), there = remembered(k, l);
    if (here < 0.0F || there < 0.0F) return;
    const float score = std::abs(here - there) / job_.config.luminance_threshold;
    raise(i, j, score), raise(k, l, score);
  }

  void score_grazing() {
    const bool own = job_.config.grazing == GrazingRule::OwnRay;
    const DMat3 world_from_view(glm::mat3_cast(job_.view.world_from_view.rotation));
    const Mat3 rotation(world_from_view);
    const Vec3 axis = -rotation[2];
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) {
        const Vec3& normal = job_.support.normal(i, j);
        if (normal == Vec3{0.0F}) continue;
        const Vec3 ray = glm::normalize(rotation * job_.view.grid.ray(cell_x(i), cell_y(j)));
        const float cosine =
            own ? std::abs(glm::dot(normal, ray)) : std::max(glm::dot(normal, axis), 0.0F);
        if (cosine < job_.config.grazing_threshold) raise(i, j, 1.0F);
      }
    }
  }

  /// A quad deserves what its corners do; a broken one is an edge, and edges move.
  Plane<float> of_quads() const {
    const Plane<std::uint8_t>& broken = job_.support.broken;
    const bool edges =
        job_.config.resampling == ResamplingRule::Neighbours || job_.motion == Motion::Moving;
    const bool turns = job_.glossy.any() && job_.motion == Motion::Moving;
    Plane<float> quads(broken.width(), broken.height());
    for (int j = 0; j < quads.height(); ++j) {
      for (int i = 0; i < quads.width(); ++i) {
        const int k = std::min(i + 1, columns_ - 1), l = std::min(j + 1, rows_ - 1);
        float score = std::max({samples_(i, j), samples_(k, j), samples_(i, l), samples_(k, l)});
        if (edges && broken(i, j) != 0) score += 1.0F;
        if (turns) score = std::max(score, turn_of_quad(i, j));
        quads(i, j) = score < 1.0F ? 0.0F : score;
      }
    }
    return quads;
  }
  /// By the cell of its diagonal that is remembered longest: corners are traced each frame.
  float turn_of_quad(int i, int j) const {
    const int x = cell_x(i), y = cell_y(j), end = cell_x(std::min(i + 1, columns_ - 1));
    if (!job_.glossy.turns->is_glossy(job_.fresh.surface_id(job_.fresh.at(x, y)))) return 0.0F;
    const Plane<CacheInfo>& info = job_.remembered.info;
    std::optional<std::uint32_t> oldest;
    for (int k = x; k < end; ++k) {
      const int row = std::min(y + k - x, info.height() - 1);
      if (!job_.remembered.remembers(k, row)) continue;
      const std::uint32_t touched = info(k, row).touched;
      if (!oldest || job_.glossy.is_older(touched, *oldest)) oldest = touched;
    }
    return oldest ? job_.glossy.turned(job_.view, {x, y}, job_.fresh, *oldest) : 0.0F;
  }
  void raise(int i, int j, float score) { samples_(i, j) = std::max(samples_(i, j), score); }

  const ResamplingJob& job_;
  int columns_, rows_;
  Plane<float> samples_;
};

}  // namespace

float display_luminance(const image::Tone& tone, const Rgb& radiance) {
  return std::sqrt(image::luminance(image::display_linear(tone, radiance)));
}

Plane<float> resampling_scores(const ResamplingJob& job) {
  return Scores(job).run();
}

}  // namespace macula::kernels::ray
