#include "server/scene/gltf/animations.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/scene/gltf/accessor.h"
#include "shared/base/text.h"

namespace macula::scene::gltf {
namespace {

constexpr double kLongest_s = 1e8;  ///< three years; nanoseconds in 64 bits reach 290

constexpr std::initializer_list<int> kFloat{TINYGLTF_COMPONENT_TYPE_FLOAT};
constexpr std::initializer_list<int> kFloatOrNormalised{
    TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_COMPONENT_TYPE_BYTE,
    TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_SHORT,
    TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT};

std::optional<Interpolation> interpolation_of(const std::string& name) {
  if (name.empty() || name == "LINEAR") return Interpolation::Linear;
  if (name == "STEP") return Interpolation::Step;
  if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
  return std::nullopt;
}

DVec3 value_in(const AccessorView& view, std::size_t i, DVec3) {
  return DVec3(view.vec3(i));
}
DQuat value_in(const AccessorView& view, std::size_t i, DQuat) {
  return {view.component(i, 3), view.component(i, 0), view.component(i, 1), view.component(i, 2)};
}
bool is_finite(const DVec3& v) {
  return math::is_finite(v);
}
bool is_finite(const DQuat& q) {
  return math::is_finite(DVec3(q.x, q.y, q.z)) && std::isfinite(q.w);
}

/// At a key a rotation is made unit; false when it has no direction. Tangents stay as they are.
bool make_unit(DVec3&) {
  return true;
}
bool make_unit(DQuat& q) {
  const double length = glm::length(q);
  if (!(length > 0.0)) return false;
  q /= length;
  return true;
}

class AnimationImporter {
 public:
  AnimationImporter(const Document& document, Warnings& warnings)
      : document_(document), warnings_(warnings) {}

  Result<std::map<int, NodeMotion>> import() {
    for (std::size_t i = 0; i < document_.model.animations.size(); ++i) {
      if (const auto done = import_animation(i); !done) return forward(done);
    }
    return std::move(motions_);
  }

 private:
  Result<void> import_animation(std::size_t index);
  Result<void> import_channel(const tinygltf::Animation& animation,
                              const tinygltf::AnimationChannel& channel, NodeMotion& motion);
  template <class Value>
  Result<void> read_track(const tinygltf::AnimationSampler& sampler, const Expected& expected,
                          Track<Value>& track);
  Result<std::vector<double>> read_times(int accessor);
  template <class Value>
  Result<void> read_values(const AccessorView& view, Track<Value>& track);

  const Document& document_;
  Warnings& warnings_;
  std::map<int, NodeMotion> motions_;
  std::string place_;
  std::size_t values_ = 0;
};

Result<void> AnimationImporter::import_animation(std::size_t index) {
  const tinygltf::Animation& animation = document_.model.animations[index];
  std::map<int, NodeMotion> own;
  for (std::size_t i = 0; i < animation.channels.size(); ++i) {
    const tinygltf::AnimationChannel& channel = animation.channels[i];
    place_ = base::concat(document_.place("animation", index), " channel ", i);
    if (channel.target_node < 0) continue;  // what an extension moves
    if (!find(document_.model.nodes, channel.target_node)) {
      return base::bad_input(base::concat("there is no node ", channel.target_node), place_,
                             base::concat("there are ", document_.model.nodes.size()));
    }
    if (motions_.contains(channel.target_node)) {
      warnings_.add("a node follows the first animation that names it; others of it are ignored");
      continue;
    }
    const auto done = import_channel(animation, channel, own[channel.target_node]);
    if (!done) return done;
  }
  double length_s = 0.0;
  for (const auto& [node, motion] : own) {
    for (const auto* times :
         {&motion.translations.times_s, &motion.rotations.times_s, &motion.scales.times_s}) {
      if (!times->empty()) length_s = std::max(length_s, times->back());
    }
  }
  for (auto& [node, motion] : own) {
    motion.period = Nanoseconds(std::llround(1e9 * length_s));
    motions_.emplace(node, std::move(motion));
  }
  return {};
}

Result<void> AnimationImporter::import_channel(const tinygltf::Animation& animation,
                                               const tinygltf::AnimationChannel& channel,
                                               NodeMotion& motion) {
  const tinygltf::AnimationSampler* sampler = find(animation.samplers, channel.sampler);
  if (!sampler) {
    return base::bad_input(base::concat("there is no sampler ", channel.sampler), place_,
                           base::concat("there are ", animation.samplers.size()));
  }
  const Expected vectors{"animation values", TINYGLTF_TYPE_VEC3, kFloat};
  const Expected rotations{"animation values", TINYGLTF_TYPE_VEC4, kFloatOrNormalised};
  const std::string& path = channel.target_path;
  if (path == "translation") return read_track(*sampler, vectors, motion.translations);
  if (path == "scale") return read_track(*sampler, vectors, motion.scales);
  if (path == "rotation") return read_track(*sampler, rotations, motion.rotations);
  warnings_.add(path == "weights" ? "animations of morph targets are ignored"
                                  : "animations of '" + path.substr(0, 40) + "' are ignored");
  return {};
}

template <class Value>
Result<void> AnimationImporter::read_track(const tinygltf::AnimationSampler& sampler,
                                           const Expected& expected, Track<Value>& track) {
  if (!track.empty()) {
    return base::bad_input("two channels move the same part of a node", place_,
                           "one channel for each of translation, rotation and scale");
  }
  const auto interpolation = interpolation_of(sampler.interpolation);
  if (!interpolation) {
    return base::bad_input("unknown interpolation '" + sampler.interpolation.substr(0, 40) + "'",
                           place_, "STEP, LINEAR or CUBICSPLINE");
  }
  auto times = read_times(sampler.input);
  if (!times) return forward(times);
  const auto view = AccessorView::create(document_, sampler.output, expected);
  if (!view) return forward(view);
  track.interpolation = *interpolation;
  track.times_s = std::move(*times);
  return read_values(*view, track);
}

Result<std::vector<double>> AnimationImporter::read_times(int accessor) {
  const auto view =
      AccessorView::create(document_, accessor, {"animation times", TINYGLTF_TYPE_SCALAR, kFloat});
  if (!view) return forward(view);
  values_ += view->count();
  if (values_ > kMaxKeyValues) {
    return base::bad_input("the animations have too many keys", place_,
                           base::concat("at most ", kMaxKeyValues, " values in a scene"));
  }
  std::vector<double> times;
  for (std::size_t i = 0; i < view->count(); ++i) {
    const double time = view->component(i, 0);
    if (!(time >= 0.0 && time <= kLongest_s) || (i > 0 && !(time > times.back()))) {
      return base::bad_input(base::concat("key ", i, " is at ", time, " s"), place_,
                             "times rise from 0 or later to at most 1e8 s");
    }
    times.push_back(time);
  }
  return times;
}

template <class Value>
Result<void> AnimationImporter::read_values(const AccessorView& view, Track<Value>& track) {
  const bool spline = track.interpolation == Interpolation::CubicSpline;
  const std::size_t wanted = (spline ? 3 : 1) * track.times_s.size();
  if (view.count() != wanted) {
    return base::bad_input(
        base::concat(view.count(), " values for ", track.times_s.size(), " keys"), place_,
        base::concat("it must have ", wanted));
  }
  values_ += wanted;
  for (std::size_t i = 0; i < wanted; ++i) {
    Value value = value_in(view, i, Value{});
    const bool is_key = !spline || i % 3 == 1;
    if (!is_finite(value) || (is_key && !make_unit(value))) {
      return base::bad_input(base::concat("value ", i, " is not usable"), place_,
                             "finite numbers; rotations other than 0");
    }
    track.values.push_back(value);
  }
  return {};
}

}  // namespace

Result<std::map<int, NodeMotion>> import_animations(const Document& document, Warnings& warnings) {
  return AnimationImporter(document, warnings).import();
}

}  // namespace macula::scene::gltf
