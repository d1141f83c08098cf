#include "server/kernels/ray/tile.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "server/kernels/ray/shading_point.h"
#include "server/kernels/ray/surface_stage.h"

namespace macula::kernels::ray {
namespace {

constexpr std::size_t kCells = visibility::kStreamCapacity;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Of a cell's random numbers (lighting.cpp has the next ones).
constexpr std::uint32_t kBlendDimension = 0x8000'0010U;
constexpr std::uint64_t kClassesKey = 0xC1A55E5U;  ///< of what all cells of a frame share

double ms_since(std::chrono::steady_clock::time_point begin) {
  return units::to_ms(std::chrono::steady_clock::now() - begin);
}

/// What a cell has gathered over its samples.
struct Cell {
  int x = 0, y = 0;
  image::Pixel at;  ///< where its sample is written
  sampling::SampleKey key;
  Rgb sum{0.0F};
  Rgb sampled_sum{0.0F}, reflectance_sum{0.0F};  ///< with kLight
  double luminance_sum = 0.0, luminance_square_sum = 0.0;
};

class TileRun {
 public:
  TileRun(const ViewContext& context, const image::Rect& tile, ViewBuffers& out)
      : context_(context), out_(out) {
    list_cells(tile);
    points_.keeps_whole = keeps_whole();
    in_vectors_ = shades_in_vectors(context.scene);
  }
  TileRun(const ViewContext& context, std::span<const image::Pixel> cells, ViewBuffers& out)
      : context_(context), out_(out) {
    for (const image::Pixel& cell : cells) add_cell(cell.x, cell.y, cell);
    points_.keeps_whole = keeps_whole();
    in_vectors_ = shades_in_vectors(context.scene);
  }
  /// Cell k is written at (k, row).
  TileRun(const ViewContext& context, std::span<const image::Pixel> cells, int row,
          ViewBuffers& out)
      : TileRun(context, cells, out) {
    for (std::size_t k = 0; k < count_; ++k) cells_[k].at = {static_cast<int>(k), row};
  }

  FrameReport run() {
    for (int s = 0; s < context_.pattern.samples(); ++s) {
      trace(s);
      gather_points(s);
      light();
      accumulate();
    }
    finish();
    report_.shadow_rays = work_.shadow_rays;
    report_.trace_ms += work_.trace_ms;
    report_.shade_ms -= work_.trace_ms;  // lighting was timed as a whole
    return report_;
  }

 private:
  bool keeps_whole() const {
    return context_.scene.plan().has(scene::Step::Environment) ||
           context_.config.virtual_lights.near_light == NearLight::Bounced;
  }
  /// 4x4 blocks, so that every packet of 16 (or 8) rays is a small square of neighbours.
  void list_cells(const image::Rect& tile) {
    for (int by = 0; by < tile.height; by += 4) {
      for (int bx = 0; bx < tile.width; bx += 4) {
        for (int y = by; y < std::min(by + 4, tile.height); ++y) {
          for (int x = bx; x < std::min(bx + 4, tile.width); ++x) {
            add_cell(tile.x + x, tile.y + y, {tile.x + x, tile.y + y});
          }
        }
      }
    }
  }
  void add_cell(int x, int y, const image::Pixel& at) {
    Cell& cell = cells_[count_++];
    cell.x = x, cell.y = y, cell.at = at;
    cell.key = {context_.seed, context_.frame, context_.view.grid.cell_key(x, y)};
  }

  void trace(int s) {
    const auto begin = std::chrono::steady_clock::now();
    rays_.clear();
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec2 at = context_.pattern.position(cells_[i].key, s);
      // z = -1 in view space: t is view depth.
      const Vec3 direction = context_.view.grid.ray(cells_[i].x, cells_[i].y, at.x, at.y);
      rays_.push(context_.eye, context_.world_from_view * direction, 0.0F, kInfinity,
                 blend_rule(cells_[i].key, s));
    }
    context_.scene.intersect(rays_, hits_, visibility::Coherence::Coherent);
    report_.primary_rays += count_;
    report_.trace_ms += ms_since(begin);
  }

  /// Exact: chance. Fast, without noise: as many of a cell's samples meet a surface as its coverage
  /// says, to the nearest; a single sample meets those that are there by half.
  visibility::BlendRule blend_rule(sampling::SampleKey key, int s) const {
    const auto index = static_cast<std::uint64_t>(s);
    if (context_.config.mode == Mode::Exact && context_.scene.triangles().blends()) {
      return visibility::blend_by_chance(sampling::sample_bits(key, kBlendDimension, index));
    }
    const auto samples = static_cast<float>(context_.pattern.samples());
    return visibility::blend_from((static_cast<float>(s) + 0.5F) / samples);
  }

  void gather_points(int s) {
    const auto begin = std::chrono::steady_clock::now();
    points_.clear();
    points_.sample = static_cast<std::uint32_t>(s);
    const bool guide = s == context_.pattern.guide();
    fetch_surfaces();
    if (in_vectors_) {
      add_groups(guide);
    } else {
      find_surfaces();
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (!hits_.hit(static_cast<int>(i))) {
        radiance_[i] = context_.scene.beyond(glm::normalize(rays_.direction(static_cast<int>(i))));
        if (guide) write_guide_miss(cells_[i]);
      } else if (!in_vectors_) {
        add_lit_point(i, guide);
      }
    }
    report_.shade_ms += ms_since(begin);
  }

  template <class Body>
  void for_each_hit(const Body& body) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (hits_.hit(static_cast<int>(i))) body(i, hits_.at(static_cast<int>(i)));
    }
  }

  /// Points lie anywhere in memory: everything is sent for before anything is waited for.
  void fetch_surfaces() const {
    if (context_.scene.triangles().packet_width() == 0) return;
    const shading::SurfaceTable& surfaces = context_.scene.surfaces();
    for_each_hit([&](std::size_t, const visibility::Hit& hit) {
      surfaces.fetch_triangle(hit.instance, hit.triangle);
    });
    for_each_hit([&](std::size_t, const visibility::Hit& hit) {
      surfaces.fetch_vertices(hit.instance, hit.triangle);
    });
  }

  /// Instance by instance.
  void add_groups(bool guide) {
    const HitGroups groups(hits_, count_);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::span<const std::uint16_t> rays = groups.rays(g);
      group_.collect(rays_, hits_, rays);
      for (std::size_t k = 0; k < rays.size(); ++k) group_.sample_area.at[k] = sample_area(rays[k]);
      group_.shade(context_.scene, context_.config);
      const std::size_t first = points_.count;
      points_.append(group_);
      for (std::size_t k = 0; k < rays.size(); ++k) {
        const std::uint16_t i = rays[k];
        owner_[first + k] = i;
        points_.keys[first + k] = cells_[i].key;
        radiance_[i] = group_.emission(k, context_.scene);
        if (guide) write_guide_hit(i, group_.reflectors.shading[k], group_.bsdfs.base[k]);
        choose_lights(cells_[i]);
      }
    }
  }

  void find_surfaces() {
    for_each_hit([&](std::size_t i, const visibility::Hit& hit) {
      const Vec3 ray = rays_.direction(static_cast<int>(i));
      const DVec3 point = context_.view.world_from_view.position + DVec3(hit.t * ray);
      ShadingRequest& request = requests_[i];
      request = {context_.scene.surface(hit, point), -glm::normalize(ray), uv_per_meter(i),
                 footprint_m(i)};
      context_.scene.materials().fetch(request.surface.material, request.surface.uv,
                                       request.footprint().uv);
    });
  }

  void add_lit_point(std::size_t i, bool guide) {
    const ShadingRequest& request = requests_[i];
    const ShadedPoint shaded = shade_point(request, context_.scene, context_.config);
    radiance_[i] = shaded.emission;
    if (guide) {
      write_guide_hit(i, shaded.reflector.frame().shading,
                      context_.scene.materials().base_color(request.surface, request.footprint()));
    }
    owner_[points_.count] = static_cast<std::uint16_t>(i);
    points_.push(request.surface, shaded.reflector, cells_[i].key);
    choose_lights(cells_[i]);
  }
  void choose_lights(const Cell& cell) {
    if (context_.cut_nodes != nullptr) {
      points_.cut_nodes.push_back((*context_.cut_nodes)(cell.x, cell.y));
    }
    if (context_.config.virtual_lights.any()) points_.light_class.push_back(light_class(cell));
  }

  /// Classes side by side; from frame to frame and sample to sample all alike by chance.
  std::uint16_t light_class(const Cell& cell) const {
    if (context_.light_class != nullptr) return (*context_.light_class)(cell.x, cell.y);
    const int classes = context_.config.virtual_lights.lights->classes();
    const int side = static_cast<int>(std::lround(std::sqrt(classes)));
    const sampling::SampleKey frame(context_.seed, context_.frame, kClassesKey);
    const std::uint32_t turn = sampling::sample_bits(frame, 0, points_.sample);
    const auto place = static_cast<std::uint32_t>(cell.x % side + side * (cell.y % side));
    return static_cast<std::uint16_t>((place + turn) % static_cast<std::uint32_t>(classes));
  }

  bool filters_textures() const {
    return context_.config.mode == Mode::Fast && context_.config.footprints == Footprints::Filtered;
  }
  float uv_per_meter(std::size_t i) const {
    if (!filters_textures()) return 0.0F;
    return context_.scene.uv_per_meter(hits_.instance[i], hits_.triangle[i]);
  }
  /// Side of the square a sample stands for, across its ray: a tangent area A at depth z covers the
  /// solid angle A cos^3 and, at distance z / cos, the area A z^2 cos.
  float footprint_m(std::size_t i) const {
    const float cosine = 1.0F / glm::length(rays_.direction(static_cast<int>(i)));
    return hits_.t[i] * std::sqrt(sample_area(i) * cosine);
  }
  /// On the tangent plane; 0: textures unfiltered.
  float sample_area(std::size_t i) const {
    if (!filters_textures()) return 0.0F;
    const Vec2 cell = context_.view.grid.footprint(cells_[i].x, cells_[i].y);
    return cell.x * cell.y / static_cast<float>(context_.pattern.samples());
  }

  void light() {
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t n = points_.count;
    for (std::size_t k = 0; k < n; ++k) lit_radiance_[k] = radiance_[owner_[k]];
    const bool split = (context_.wanted & kLight) != 0;
    context_.lighting.add(points_, {lit_radiance_.data(), n}, work_,
                          {sampled_.data(), split ? n : 0});
    for (std::size_t k = 0; k < n; ++k) radiance_[owner_[k]] = lit_radiance_[k];
    if (split) accumulate_light();
    report_.shade_ms += ms_since(begin);
  }

  void accumulate_light() {
    for (std::size_t k = 0; k < points_.count; ++k) {
      if (!math::is_finite(lit_radiance_[k])) continue;
      Cell& cell = cells_[owner_[k]];
      cell.sampled_sum += sampled_[k];
      cell.reflectance_sum += points_.reflectors.reflectance[k];
    }
  }

  void accumulate() {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!math::is_finite(radiance_[i])) {
        radiance_[i] = Rgb{0.0F};
        ++report_.non_finite_samples;
      }
      Cell& cell = cells_[i];
      cell.sum += radiance_[i];
      if ((context_.wanted & kVariance) == 0) continue;
      const double luminance = image::luminance(radiance_[i]);
      cell.luminance_sum += luminance;
      cell.luminance_square_sum += luminance * luminance;
    }
  }

  void finish() {
    const int n = context_.pattern.samples();
    for (std::size_t i = 0; i < count_; ++i) {
      const Cell& cell = cells_[i];
      out_.radiance(cell.at.x, cell.at.y) = cell.sum / static_cast<float>(n);
      if (context_.wanted & kSamples) out_.samples(cell.at.x, cell.at.y) = static_cast<float>(n);
      if (context_.wanted & kVariance)
        out_.variance(cell.at.x, cell.at.y) = variance_of_mean(cell, n);
      if (context_.wanted & kLight) write_light(cell, n);
    }
  }
  /// Unknown, hence infinite, for a single sample.
  static float variance_of_mean(const Cell& cell, int n) {
    if (n < 2) return kInfinity;
    const double mean = cell.luminance_sum / n;
    const double spread = cell.luminance_square_sum / n - mean * mean;
    return static_cast<float>(std::max(spread, 0.0) / (n - 1));
  }

  /// Light per reflectance such that their product is the mean of what was reflected.
  void write_light(const Cell& cell, int n) {
    Rgb light{0.0F};
    for (int c = 0; c < 3; ++c) {
      if (cell.reflectance_sum[c] > 0.0F) light[c] = cell.sampled_sum[c] / cell.reflectance_sum[c];
    }
    out_.light(cell.at.x, cell.at.y) = light;
    out_.reflectance(cell.at.x, cell.at.y) = cell.reflectance_sum / static_cast<float>(n);
  }

  void write_guide_miss(const Cell& cell) {
    out_.depth_m(cell.at.x, cell.at.y) = kInfinity;
    if (context_.wanted & kSurfaceId) out_.surface_id(cell.at.x, cell.at.y) = 0;
    if (context_.wanted & kNormal) out_.normal(cell.at.x, cell.at.y) = Vec3{0.0F};
    if (context_.wanted & kAlbedo) out_.albedo(cell.at.x, cell.at.y) = Rgb{0.0F};
  }
  void write_guide_hit(std::size_t i, const Vec3& normal, const Rgb& base_color) {
    const Cell& cell = cells_[i];
    out_.depth_m(cell.at.x, cell.at.y) = central_depth(i);
    if (context_.wanted & kSurfaceId) out_.surface_id(cell.at.x, cell.at.y) = hits_.instance[i] + 1;
    if (context_.wanted & kNormal) out_.normal(cell.at.x, cell.at.y) = normal;
    if (context_.wanted & kAlbedo) out_.albedo(cell.at.x, cell.at.y) = base_color;
  }
  /// View depth where the plane of the surface that the guide hit meets the ray through the cell's
  /// centre: for d along the guide's ray and c along the central one, both with z = -1 in view
  /// space, n.(t d) = n.(z c). A plane seen too edge-on to be followed that far (beyond a factor of
  /// 2 in depth) keeps the guide's own depth.
  float central_depth(std::size_t i) const {
    const float t = hits_.t[i];
    if (context_.pattern.guide_is_central()) return t;
    const Vec3 normal = hits_.normal(static_cast<int>(i));
    const Vec3 central =
        context_.world_from_view * context_.view.grid.ray(cells_[i].x, cells_[i].y);
    const float ratio =
        glm::dot(normal, rays_.direction(static_cast<int>(i))) / glm::dot(normal, central);
    return ratio > 0.5F && ratio < 2.0F ? t * ratio : t;
  }

  const ViewContext& context_;
  ViewBuffers& out_;
  FrameReport report_;
  LightingWork work_;
  std::size_t count_ = 0;
  std::array<Cell, kCells> cells_;
  visibility::RayStream rays_;
  visibility::HitStream hits_;
  LitPoints points_{};
  bool in_vectors_ = false;
  SurfaceGroup group_;                           ///< whole vectors are filled before they are read
  std::array<ShadingRequest, kCells> requests_;  ///< of the rays that hit
  std::array<std::uint16_t, kCells> owner_;
  std::array<Rgb, kCells> radiance_, lit_radiance_, sampled_;
};

}  // namespace

ViewContext::ViewContext(const View& shown, const SceneFrame& frame_scene, const Config& settings,
                         const FrameRequest& request, unsigned planes)
    : view(shown),
      scene(frame_scene),
      config(settings),
      pattern(settings.samples_per_cell, settings.placement),
      lighting(frame_scene, settings),
      frame(request.frame),
      seed(request.seed),
      wanted(planes),
      world_from_view(glm::mat3_cast(shown.world_from_view.rotation)),
      eye(shown.world_from_view.position) {}

FrameReport render_tile(const ViewContext& context, const image::Rect& tile, ViewBuffers& out) {
  return TileRun(context, tile, out).run();
}

FrameReport render_cells(const ViewContext& context, std::span<const image::Pixel> cells,
                         ViewBuffers& out) {
  MACULA_DCHECK(cells.size() <= kCells);
  return TileRun(context, cells, out).run();
}

FrameReport render_cells(const ViewContext& context, std::span<const image::Pixel> cells, int row,
                         ViewBuffers& out) {
  MACULA_DCHECK(cells.size() <= kCells);
  return TileRun(context, cells, row, out).run();
}

}  // namespace macula::kernels::ray
