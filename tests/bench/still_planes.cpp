#include "tests/bench/still_planes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "server/exr/exr.h"
#include "shared/base/text.h"
#include "shared/image/tone.h"
#include "shared/math/hash.h"
#include "tests/bench/figure_sheet.h"

namespace macula::bench {
namespace {

using image::Plane;

// ---- from cells to pixels ----

template <class T>
Plane<T> on_display(const Plane<T>& cells, const StillJob& job) {
  const PixelGrid raster = foveation::make_uniform_grid(job.display);
  if (raster == job.view.grid) return cells;
  Plane<T> pixels(raster.width(), raster.height());
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      const auto at = job.view.grid.locate(raster.tangent(x, y));
      if (!at) continue;
      pixels(x, y) = cells(std::min(static_cast<int>(at->x), cells.width() - 1),
                           std::min(static_cast<int>(at->y), cells.height() - 1));
    }
  }
  return pixels;
}

template <class T, class Value>
Plane<float> component(const Plane<T>& plane, Value value) {
  Plane<float> result(plane.width(), plane.height());
  std::ranges::transform(plane.pixels(), result.pixels().begin(),
                         [&](const T& pixel) { return static_cast<float>(value(pixel)); });
  return result;
}

template <class T>
StillLayer vector_layer(StillPlane kind, const std::string& name, const Plane<T>& plane,
                        const char* suffixes) {
  StillLayer layer{kind, name, {}};
  for (int c = 0; c < 3; ++c) {
    layer.channels.emplace_back(base::concat(name, ".", suffixes[c]),
                                component(plane, [c](const T& v) { return v[c]; }));
  }
  return layer;
}
StillLayer scalar_layer(StillPlane kind, const std::string& name, const char* channel,
                        Plane<float> plane) {
  StillLayer layer{kind, name, {}};
  layer.channels.emplace_back(base::concat(name, ".", channel), std::move(plane));
  return layer;
}

StillLayer make_layer(StillPlane plane, const kernels::ViewBuffers& planes, const StillJob& job) {
  switch (plane) {
    case StillPlane::Depth:
      return scalar_layer(plane, "depth", "Z", on_display(planes.depth_m, job));
    case StillPlane::Normal:
      return vector_layer(plane, "normal", on_display(planes.normal, job), "XYZ");
    case StillPlane::Albedo:
      return vector_layer(plane, "albedo", on_display(planes.albedo, job), "RGB");
    case StillPlane::Id:
      return scalar_layer(plane, "id", "Y",
                          component(on_display(planes.surface_id, job), std::identity{}));
    case StillPlane::Rate:
      return scalar_layer(plane, "rate", "Y", on_display(planes.rate, job));
    case StillPlane::Samples:
      return scalar_layer(plane, "samples", "Y", on_display(planes.samples, job));
    case StillPlane::Variance:
      return scalar_layer(plane, "variance", "Y", on_display(planes.variance, job));
    case StillPlane::Steps:
      return scalar_layer(plane, "steps", "Y", on_display(planes.steps, job));
  }
  return {};
}

// ---- what people see ----

/// Normals from [-1, 1]; albedo as a display shows it.
Plane<Rgb8> as_color(const StillLayer& layer) {
  const Plane<float>& first = layer.channels.front().second;
  Plane<Rgb8> picture(first.width(), first.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    Rgb color{first.pixels()[i], layer.channels[1].second.pixels()[i],
              layer.channels[2].second.pixels()[i]};
    if (layer.plane == StillPlane::Normal) color = 0.5F * color + 0.5F;
    picture.pixels()[i] = image::encode(image::Tone{}, color);
  }
  return picture;
}

/// A bright colour an id; 0, nothing hit, is black.
Rgb8 color_of_id(float id) {
  if (!(id > 0.0F)) return {};
  const std::uint64_t bits = math::hash_mix(static_cast<std::uint64_t>(id));
  const auto channel = [bits](int shift) {
    return static_cast<std::uint8_t>(64 + ((bits >> shift) & 0xFF) * 191 / 255);
  };
  return {channel(0), channel(8), channel(16)};
}

Plane<Rgb8> as_ids(const Plane<float>& ids) {
  Plane<Rgb8> picture(ids.width(), ids.height());
  std::ranges::transform(ids.pixels(), picture.pixels().begin(), color_of_id);
  return picture;
}

struct Range {
  float low = 0.0F, high = 1.0F;
};
/// Of the finite values; empty planes and constants get a range around their value.
Range percentiles(const Plane<float>& plane) {
  std::vector<float> values;
  std::ranges::copy_if(plane.pixels(), std::back_inserter(values),
                       [](float v) { return std::isfinite(v); });
  if (values.empty()) return {};
  const auto at = [&values](double share) {
    const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + n, values.end());
    return values[static_cast<std::size_t>(n)];
  };
  const Range range{at(0.01), at(0.99)};
  return range.low < range.high ? range : Range{range.low - 0.5F, range.low + 0.5F};
}

std::string title_of(StillPlane plane) {
  switch (plane) {
    case StillPlane::Depth:
      return "depth, m";
    case StillPlane::Rate:
      return "rate, samples per display pixel";
    case StillPlane::Samples:
      return "samples per cell";
    case StillPlane::Steps:
      return "steps";
    case StillPlane::Variance:
      return "variance of the mean luminance";
    case StillPlane::Normal:
    case StillPlane::Albedo:
    case StillPlane::Id:
      break;
  }
  return {};
}

Plane<Rgb8> as_false_color(const StillLayer& layer) {
  Plane<float> values = layer.channels.front().second;
  const Ticks ticks = layer.plane == StillPlane::Variance ? Ticks::Decades : Ticks::Linear;
  if (ticks == Ticks::Decades) {
    // log10(0) is -infinity: outside the range, and drawn as its low end.
    for (float& value : values.pixels()) value = std::log10(value);
  }
  const Range range = percentiles(values);
  const ColorScale scale{title_of(layer.plane), range.low, range.high, ticks};
  return stacked(false_color(values, scale), scale_bar(scale, values.width()));
}

}  // namespace

Plane<Rgb> radiance_on_display(const StillJob& job, const RenderedStill& rendered) {
  return on_display(rendered.planes.radiance, job);
}

std::vector<StillLayer> make_layers(const StillOptions& options, const StillJob& job,
                                    const RenderedStill& rendered) {
  std::vector<StillLayer> layers;
  for (const StillPlane plane : options.planes) {
    layers.push_back(make_layer(plane, rendered.planes, job));
  }
  return layers;
}

Plane<Rgb8> picture_of(const StillLayer& layer) {
  switch (layer.plane) {
    case StillPlane::Normal:
    case StillPlane::Albedo:
      return as_color(layer);
    case StillPlane::Id:
      return as_ids(layer.channels.front().second);
    default:
      return as_false_color(layer);
  }
}

Result<void> write_layered_exr(const std::string& path, const Plane<Rgb>& radiance,
                               const std::vector<StillLayer>& layers) {
  std::vector<Plane<float>> beauty;
  for (int c = 0; c < 3; ++c) {
    beauty.push_back(component(radiance, [c](const Rgb& value) { return value[c]; }));
  }
  std::vector<exr::NamedPlane> channels{{"R", &beauty[0]}, {"G", &beauty[1]}, {"B", &beauty[2]}};
  for (const StillLayer& layer : layers) {
    for (const auto& [name, plane] : layer.channels) channels.push_back({name, &plane});
  }
  return exr::write_layers(path, channels);
}

}  // namespace macula::bench
