#include "server/kernels/brute.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "server/kernels/planes.h"
#include "server/sampling/sample.h"
#include "shared/base/check.h"

namespace macula::kernels {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kBlendDimension = 0x8000'0000U;  ///< RandomStream's start at 0

/// One sample's random numbers, drawn in order.
class RandomStream {
 public:
  RandomStream(std::uint64_t key, int sample) { key_.value = math::hash_combine(key, sample + 1); }
  float next() { return sampling::sample(key_, dimension_++); }
  /// A stream of its own for one term, so that no term's appetite shifts another's numbers.
  RandomStream branch() { return RandomStream(key_.value, static_cast<int>(dimension_++)); }

 private:
  sampling::SampleKey key_;
  std::uint32_t dimension_ = 0;
};

/// A surface point with its material, ready to be asked for light.
struct Vertex {
  shading::Surface surface;
  shading::Reflector reflector;
  Rgb emission{0.0F};
};

class Tracer {
 public:
  Tracer(const SceneFrame& scene, const KernelOptions& options)
      : scene_(scene), options_(options) {}

  /// What follows belongs to this sample; its rays meet blended surfaces by chances of their own.
  void begin(std::uint64_t key, int sample) {
    blending_.value = math::hash_combine(math::hash_combine(key, sample), kBlendDimension);
    rays_begun_ = 0;
  }
  visibility::BlendRule next_blend_rule() {
    return visibility::blend_by_chance(sampling::sample_bits(blending_, 0, rays_begun_++));
  }

  Vertex vertex(const shading::Surface& surface, const Vec3& to_eye) const {
    const auto model =
        options_.lambert_only ? shading::MaterialModel::Lambert : shading::MaterialModel::AsInScene;
    Vertex vertex{surface, {}, Rgb{0.0F}};
    vertex.reflector = shading::Reflector(
        scene_.materials().bsdf(surface, {}, model),
        shading::make_shading_frame(surface.geometric_normal, surface.shading_normal, to_eye));
    if (glm::dot(surface.geometric_normal, to_eye) > 0.0F) {
      vertex.emission = scene_.materials().emission(surface.material, surface.uv, 0.0F);
    }
    return vertex;
  }

  /// Everything but emission: light reflected at the vertex towards its eye.
  Rgb reflected(const Vertex& vertex, int bounces, RandomStream& random) {
    RandomStream for_emissive = random.branch(), for_ambient = random.branch();
    RandomStream for_environment = random.branch();
    Rgb sum = from_punctual(vertex) + from_emissive(vertex, for_emissive) +
              from_ambient(vertex, for_ambient) + from_environment(vertex, for_environment);
    if (bounces > 0) sum += from_bounce(vertex, bounces, random);
    return sum;
  }

  std::uint64_t shadow_rays = 0;

 private:
  Vec3 leave(const Vertex& vertex) const {
    return visibility::offset_ray_origin(Vec3(vertex.surface.position),
                                         vertex.reflector.frame().geometric, 0.0F,
                                         vertex.surface.span_m);
  }
  bool open(const Vec3& origin, const Vec3& direction, float tfar) {
    ++shadow_rays;
    return !scene_.occluded(visibility::Ray{origin, direction, 0.0F, tfar, next_blend_rule()});
  }

  Rgb from_punctual(const Vertex& vertex) {
    Rgb sum{0.0F};
    for (const scene::Light& light : scene_.lights().punctual()) {
      const auto arrival = lights::arriving(light, vertex.surface.position);
      if (!arrival) continue;
      const Rgb value = vertex.reflector.evaluate(arrival->to_light) * arrival->irradiance;
      if (value == Rgb{0.0F}) continue;
      const Vec3 origin = leave(vertex);
      const bool visible = std::isinf(arrival->distance_m)
                               ? open(origin, arrival->to_light, kInfinity)
                               : open(origin, Vec3(light.position - DVec3(origin)), 1.0F);
      if (visible) sum += value;
    }
    return sum;
  }

  /// Triangles are drawn all alike and points by folding the square: nothing of LightList's
  /// sampling.
  Rgb from_emissive(const Vertex& vertex, RandomStream& random) {
    const auto lights = scene_.lights().emissive();
    if (lights.empty()) return Rgb{0.0F};
    Rgb sum{0.0F};
    for (int k = 0; k < options_.area_light_samples; ++k) {
      const auto count = static_cast<float>(lights.size());
      const auto index =
          std::min(static_cast<std::size_t>(random.next() * count), lights.size() - 1);
      float b1 = random.next(), b2 = random.next();
      if (b1 + b2 > 1.0F) b1 = 1.0F - b1, b2 = 1.0F - b2;
      sum += count * from_light_point(vertex, static_cast<std::uint32_t>(index), {b1, b2});
    }
    return sum / static_cast<float>(options_.area_light_samples);
  }
  /// One point of one triangle, divided by its density over that triangle.
  Rgb from_light_point(const Vertex& vertex, std::uint32_t index, const Vec2& b) {
    const lights::EmissiveTriangle& light = scene_.lights().emissive()[index];
    const DVec3 point = light.position + static_cast<double>(b.x) * DVec3(light.edge1) +
                        static_cast<double>(b.y) * DVec3(light.edge2);
    const Vec3 towards(point - vertex.surface.position);
    const float distance = glm::length(towards);
    const Vec3 to_light = towards / distance;
    const float cos_light = -glm::dot(light.normal, to_light);
    if (!(cos_light > 0.0F)) return Rgb{0.0F};
    const Rgb value = vertex.reflector.evaluate(to_light);
    if (value == Rgb{0.0F}) return value;
    const Vec3 origin = leave(vertex);
    const float edge = std::max(glm::length(light.edge1), glm::length(light.edge2));
    const Vec3 end =
        visibility::offset_ray_origin(Vec3(point), light.normal, 0.0F, std::max(distance, edge));
    if (!open(origin, end - origin, 1.0F)) return Rgb{0.0F};
    const Rgb emission = scene_.lights().emission(index, b, scene_.surfaces(), scene_.materials());
    return value * emission * (cos_light * light.area_m2 / (distance * distance));
  }

  /// The ambient term as README.md of kernel `ray` defines it.
  Rgb from_ambient(const Vertex& vertex, RandomStream& random) {
    const scene::Settings& settings = scene_.scene().settings;
    if (!scene_.plan().has(scene::Step::Ambient) || options_.ambient_samples == 0) {
      return Rgb{0.0F};
    }
    int open_count = 0;
    for (int k = 0; k < options_.ambient_samples; ++k) {
      const Vec3 direction = cosine_direction(vertex.reflector.frame(), random);
      open_count += open(leave(vertex), direction, static_cast<float>(settings.ambient_distance_m));
    }
    const float share =
        static_cast<float>(open_count) / static_cast<float>(options_.ambient_samples);
    return settings.ambient * vertex.reflector.reflectance() * share;
  }
  /// A point of the unit sphere plus the normal is cosine-distributed about the normal.
  static Vec3 cosine_direction(const shading::ShadingFrame& frame, RandomStream& random) {
    const float z = 1.0F - 2.0F * random.next();
    const float phi = 2.0F * std::numbers::pi_v<float> * random.next();
    const float radius = std::sqrt(std::max(0.0F, 1.0F - z * z));
    const Vec3 sum = frame.shading + Vec3(radius * std::cos(phi), radius * std::sin(phi), z);
    const float length = glm::length(sum);
    const Vec3 direction = length > 0.0F ? sum / length : frame.shading;
    const float height = glm::dot(direction, frame.geometric);
    return height < 0.0F ? direction - 2.0F * height * frame.geometric : direction;
  }

  /// By the surface's own directions: nothing of EnvironmentLight's table.
  Rgb from_environment(const Vertex& vertex, RandomStream& random) {
    if (!scene_.plan().has(scene::Step::Environment)) return Rgb{0.0F};
    Rgb sum{0.0F};
    for (int k = 0; k < options_.environment_samples; ++k) {
      const float u0 = random.next(), u1 = random.next(), u2 = random.next();
      const auto scattered = vertex.reflector.sample({u0, u1, u2});
      if (scattered && open(leave(vertex), scattered->to_light, kInfinity)) {
        sum += scattered->weight * scene_.environment().radiance(scattered->to_light);
      }
    }
    return sum / static_cast<float>(options_.environment_samples);
  }

  /// One more segment. Emission met there was counted by from_emissive here already, and what lies
  /// beyond by from_environment.
  Rgb from_bounce(const Vertex& vertex, int bounces, RandomStream& random) {
    const float u0 = random.next(), u1 = random.next(), u2 = random.next();
    const auto scattered = vertex.reflector.sample({u0, u1, u2});
    if (!scattered) return Rgb{0.0F};
    const Vec3 origin = leave(vertex);
    const auto hit = scene_.intersect(
        visibility::Ray{origin, scattered->to_light, 0.0F, kInfinity, next_blend_rule()});
    if (!hit) return Rgb{0.0F};
    const shading::Surface surface =
        scene_.surface(*hit, DVec3(origin + hit->t * scattered->to_light));
    const Vertex next = this->vertex(surface, -scattered->to_light);
    return scattered->weight * reflected(next, bounces - 1, random);
  }

  const SceneFrame& scene_;
  const KernelOptions& options_;
  sampling::SampleKey blending_;
  std::uint64_t rays_begun_ = 0;
};

/// One row of cells of one view.
class RowRun {
 public:
  RowRun(const FrameRequest& request, std::size_t view, const SceneFrame& scene,
         const KernelOptions& options, FrameBuffers& out)
      : request_(request),
        view_(request.views[view]),
        scene_(scene),
        options_(options),
        wanted_(out.wanted),
        out_(out.views[view]),
        tracer_(scene, options) {}

  FrameReport run(int y) {
    for (int x = 0; x < view_.grid.width(); ++x) render_cell(x, y);
    report_.shadow_rays = tracer_.shadow_rays;
    return report_;
  }

 private:
  void render_cell(int x, int y) {
    write_centre(x, y);
    const std::uint64_t key =
        sampling::SampleKey(request_.seed, request_.frame, view_.grid.cell_key(x, y)).value;
    DVec3 sum{0.0};
    double luminance = 0.0, square = 0.0;
    const int n = options_.samples_per_cell;
    for (int s = 0; s < n; ++s) {
      Rgb value = radiance(x, y, key, s);
      if (!math::is_finite(value)) {
        value = Rgb{0.0F};
        ++report_.non_finite_samples;
      }
      sum += DVec3(value);
      luminance += image::luminance(value);
      square += static_cast<double>(image::luminance(value)) * image::luminance(value);
    }
    out_.radiance(x, y) = Rgb(sum / static_cast<double>(n));
    if (wanted_ & kSamples) out_.samples(x, y) = static_cast<float>(n);
    if (wanted_ & kVariance) {
      const double spread = std::max(square / n - (luminance / n) * (luminance / n), 0.0);
      out_.variance(x, y) = n > 1 ? static_cast<float>(spread / (n - 1)) : kInfinity;
    }
  }

  std::optional<visibility::Hit> trace(const Vec3& view_direction, visibility::BlendRule rule) {
    ++report_.primary_rays;
    const Vec3 direction(view_.world_from_view.transform_direction(DVec3(view_direction)));
    return scene_.intersect(
        visibility::Ray{Vec3(view_.world_from_view.position), direction, 0.0F, kInfinity, rule});
  }
  Rgb beyond(const Vec3& view_direction) const {
    const DVec3 direction = view_.world_from_view.transform_direction(DVec3(view_direction));
    return scene_.beyond(Vec3(glm::normalize(direction)));
  }
  Vertex vertex_of(const visibility::Hit& hit, const Vec3& view_direction) {
    const DVec3 along = view_.world_from_view.transform_direction(DVec3(view_direction));
    const shading::Surface surface =
        scene_.surface(hit, view_.world_from_view.position + static_cast<double>(hit.t) * along);
    return tracer_.vertex(surface, Vec3(-glm::normalize(along)));
  }

  Rgb radiance(int x, int y, std::uint64_t key, int s) {
    RandomStream random(key, s);
    tracer_.begin(key, s);
    const Vec2 at = sample_position(s, random);
    const Vec3 direction = view_.grid.ray(x, y, at.x, at.y);
    const auto hit = trace(direction, tracer_.next_blend_rule());
    if (!hit) return beyond(direction);
    const Vertex vertex = vertex_of(*hit, direction);
    return vertex.emission + tracer_.reflected(vertex, options_.bounces.value_or(0), random);
  }
  /// Independent and uniform, or the centres of a k x k pattern (other counts: along the diagonal).
  Vec2 sample_position(int s, RandomStream& random) const {
    if (options_.jitter) {
      const float fx = random.next();
      return {fx, random.next()};
    }
    const int n = options_.samples_per_cell;
    const int side = static_cast<int>(std::lround(std::sqrt(n)));
    if (side * side != n) return Vec2{(static_cast<float>(s) + 0.5F) / static_cast<float>(n)};
    return (Vec2{static_cast<float>(s % side), static_cast<float>(s / side)} + 0.5F) /
           static_cast<float>(side);
  }

  /// The planes that cannot be averaged come from a ray of their own through the cell's centre,
  /// which meets blended surfaces that are there by half.
  void write_centre(int x, int y) {
    const Vec3 direction = view_.grid.ray(x, y);
    const auto hit = trace(direction, visibility::blend_from(0.5F));
    out_.depth_m(x, y) = hit ? hit->t : kInfinity;
    if (wanted_ & kSurfaceId) out_.surface_id(x, y) = hit ? hit->instance + 1 : 0;
    if ((wanted_ & (kNormal | kAlbedo)) == 0) return;
    const Vertex vertex = hit ? vertex_of(*hit, direction) : Vertex{};
    if (wanted_ & kNormal) {
      out_.normal(x, y) = hit ? vertex.reflector.frame().shading : Vec3{0.0F};
    }
    if (wanted_ & kAlbedo) {
      out_.albedo(x, y) = hit ? scene_.materials().base_color(vertex.surface) : Rgb{0.0F};
    }
  }

  const FrameRequest& request_;
  const View& view_;
  const SceneFrame& scene_;
  const KernelOptions& options_;
  unsigned wanted_;
  ViewBuffers& out_;
  Tracer tracer_;
  FrameReport report_;
};

}  // namespace

FrameReport BruteKernel::render(const FrameRequest& request, const SceneFrame& scene, History&,
                                TileScheduler& scheduler, FrameBuffers& out) const {
  prepare_buffers(request.views, out);
  FrameReport report;
  for (std::size_t v = 0; v < request.views.size() && !report.stopped; ++v) {
    std::vector<FrameReport> rows(static_cast<std::size_t>(request.views[v].grid.height()));
    const auto outcome = scheduler.run(rows.size(), [&](std::size_t y) {
      rows[y] = RowRun(request, v, scene, options_, out).run(static_cast<int>(y));
    });
    report.stopped = outcome == scheduling::Outcome::Stopped;
    for (const FrameReport& row : rows) {
      report.primary_rays += row.primary_rays;
      report.shadow_rays += row.shadow_rays;
      report.non_finite_samples += row.non_finite_samples;
    }
  }
  if (!report.stopped) {
    report.stopped = fill_rate(request, scheduler, out) == scheduling::Outcome::Stopped;
  }
  return report;
}

void BruteKernel::shade(std::span<const SurfacePoint> points, const SceneFrame& scene,
                        TileScheduler& scheduler, std::span<Rgb> out) const {
  MACULA_CHECK(points.size() == out.size());
  scheduler.run(points.size(), [&](std::size_t i) {
    const SurfacePoint& point = points[i];
    Tracer tracer(scene, options_);
    const Vertex vertex = tracer.vertex(scene.surface(point.hit(), point.position), point.to_eye);
    Rgb sum = vertex.emission;
    const float share = 1.0F / static_cast<float>(options_.samples_per_cell);
    for (int s = 0; s < options_.samples_per_cell; ++s) {
      RandomStream random(point.key, s);
      tracer.begin(point.key, s);
      sum += share * tracer.reflected(vertex, options_.bounces.value_or(0), random);
    }
    out[i] = math::is_finite(sum) ? sum : Rgb{0.0F};
  });
}

}  // namespace macula::kernels
