// From a Scene to Embree's two levels.
#include <cstring>
#include <map>

#include "server/visibility/state.h"

namespace macula::visibility {
namespace {

/// Meshes below this many triangles are copied per instance: entering an instance costs more than
/// their share of the top level.
constexpr std::size_t kFewTriangles = 256;
/// Below this many triangles a packet finds its few nodes in the nearest cache whatever its rays'
/// directions, and beats a stream.
constexpr std::size_t kLeastForStreams = 1000;

RTCBuildQuality build_quality(BuildQuality quality) {
  switch (quality) {
    case BuildQuality::Low:
      return RTC_BUILD_QUALITY_LOW;
    case BuildQuality::Medium:
      return RTC_BUILD_QUALITY_MEDIUM;
    case BuildQuality::High:
      return RTC_BUILD_QUALITY_HIGH;
  }
  return RTC_BUILD_QUALITY_MEDIUM;
}

bool is_finite(const DMat4& m) {
  for (int column = 0; column < 4; ++column) {
    if (!math::is_finite(DVec3(m[column])) || !std::isfinite(m[column].w)) return false;
  }
  return true;
}

/// Cofactors of the linear part with the sign of its determinant: inverse transpose times a
/// positive number, so that normals stay on the front side under mirroring.
DMat3 normal_matrix(const DMat3& linear) {
  const DMat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                        glm::cross(linear[0], linear[1]));
  const double determinant = glm::dot(linear[0], cofactors[0]);
  const double size = glm::length(cofactors[0]) + glm::length(cofactors[1]) +
                      glm::length(cofactors[2]);  // keeps float normals far from underflow
  return cofactors * ((determinant < 0.0 ? -1.0 : 1.0) / size);
}

/// Embree takes the normal of moved vertices by their winding, which a mirroring transform turns.
Mat3 flat_normal_matrix(const DMat3& linear) {
  const double determinant = glm::dot(linear[0], glm::cross(linear[1], linear[2]));
  return Mat3(determinant < 0.0 ? -1.0F : 1.0F);
}

/// |det| relative to the lengths of the columns: 1 for orthogonal, 0 for a collapsed transform.
bool is_invertible(const DMat3& linear) {
  constexpr double kLeastVolume = 1e-6;  // below it, float instance transforms lose all digits
  const double volume = std::abs(glm::dot(linear[0], glm::cross(linear[1], linear[2])));
  const double box = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return box > 0.0 && volume > kLeastVolume * box;
}

/// Embree's filter callback: the surface is not there where alpha says so.
void alpha_filter(const RTCFilterFunctionNArguments* call) {
  const auto& test = *static_cast<const AlphaTest*>(call->geometryUserPtr);
  for (unsigned i = 0; i < call->N; ++i) {
    if (call->valid[i] != -1) continue;
    const float u = RTCHitN_u(call->hit, call->N, i), v = RTCHitN_v(call->hit, call->N, i);
    if (!test.is_there(RTCHitN_primID(call->hit, call->N, i), u, v)) call->valid[i] = 0;
  }
}

class Builder {
 public:
  Builder(const scene::Scene& scene, const scene::ScenePose& pose, const Options& options,
          SceneState& state)
      : scene_(scene),
        pose_(pose),
        options_(options),
        state_(state),
        all_flat_(scene.triangle_count() <= options.flat_triangles),
        uses_(scene.meshes.size(), 0) {}
  /// Fills state; a device error shows up in state.device_error.
  void build();

 private:
  RTCScene new_scene() const;
  RTCGeometry new_triangles(scene::Index mesh, const DMat4& transform);
  RTCGeometry new_instance_of(RTCScene child, const DMat4& transform) const;
  RTCScene child_of(scene::Index mesh);
  AlphaUse alpha_of(const scene::Mesh& mesh) const;
  const AlphaTest& alpha_test(scene::Index mesh);
  bool goes_flat(scene::Index instance) const;
  void add(scene::Index index);

  const scene::Scene& scene_;
  const scene::ScenePose& pose_;
  const Options& options_;
  SceneState& state_;
  const bool all_flat_;
  std::vector<std::size_t> uses_;              ///< instances of each mesh
  std::map<scene::Index, RTCScene> children_;  ///< of shared meshes, owned until build() ends
  std::map<scene::Index, const AlphaTest*> alpha_tests_;
};

RTCScene Builder::new_scene() const {
  const RTCScene made = rtcNewScene(state_.device);
  rtcSetSceneFlags(
      made, options_.edges == EdgeTest::Robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(made, build_quality(options_.quality));
  return made;
}

AlphaUse Builder::alpha_of(const scene::Mesh& mesh) const {
  if (options_.alpha_test == scene::StepUse::LeftOut) return AlphaUse::AlwaysThere;
  const AlphaUse use = alpha_use(scene_, mesh);
  const bool forced = options_.alpha_test == scene::StepUse::Forced;
  return forced && use == AlphaUse::AlwaysThere ? AlphaUse::PerTexel : use;
}

const AlphaTest& Builder::alpha_test(scene::Index mesh) {
  const AlphaTest*& known = alpha_tests_[mesh];
  if (known == nullptr) {
    state_.alpha_tests.push_back(std::make_unique<AlphaTest>(scene_, scene_.meshes[mesh]));
    known = state_.alpha_tests.back().get();
  }
  return *known;
}

void copy_vertices(RTCGeometry geometry, std::span<const Vec3> positions, const DMat4& transform) {
  auto* out = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), positions.size()));
  if (out == nullptr) return;  // out of memory: reported by the device
  for (const Vec3& position : positions) {
    const DVec4 moved = transform * DVec4(position, 1.0);
    for (int axis = 0; axis < 3; ++axis) *out++ = static_cast<float>(moved[axis]);
  }
}

void copy_triangles(RTCGeometry geometry, const scene::Mesh& mesh) {
  static_assert(sizeof(UVec3) == 3 * sizeof(unsigned));
  void* out = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                      sizeof(UVec3), mesh.triangles.size());
  if (out == nullptr) return;
  std::memcpy(out, mesh.triangles.data(), mesh.triangles.size() * sizeof(UVec3));
}

RTCGeometry Builder::new_triangles(scene::Index mesh_index, const DMat4& transform) {
  const scene::Mesh& mesh = scene_.meshes[mesh_index];
  const RTCGeometry geometry = rtcNewGeometry(state_.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, build_quality(options_.quality));
  copy_vertices(geometry, pose_.positions(scene_, mesh_index), transform);
  copy_triangles(geometry, mesh);
  if (alpha_of(mesh) == AlphaUse::PerTexel) {
    rtcSetGeometryUserData(geometry, const_cast<AlphaTest*>(&alpha_test(mesh_index)));
    rtcSetGeometryIntersectFilterFunction(geometry, alpha_filter);
    rtcSetGeometryOccludedFilterFunction(geometry, alpha_filter);
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCScene Builder::child_of(scene::Index mesh) {
  RTCScene& child = children_[mesh];
  if (child == nullptr) {
    child = new_scene();
    const RTCGeometry geometry = new_triangles(mesh, DMat4(1.0));
    rtcAttachGeometry(child, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(child);
  }
  return child;
}

RTCGeometry Builder::new_instance_of(RTCScene child, const DMat4& transform) const {
  const RTCGeometry geometry = rtcNewGeometry(state_.device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, child);
  rtcSetGeometryTimeStepCount(geometry, 1);
  float columns[12];
  for (int i = 0; i < 12; ++i) columns[i] = static_cast<float>(transform[i / 3][i % 3]);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(geometry);
  return geometry;
}

bool Builder::goes_flat(scene::Index instance) const {
  const scene::Index mesh = scene_.instances[instance].mesh;
  return all_flat_ || uses_[mesh] < 2 || scene_.meshes[mesh].triangles.size() < kFewTriangles ||
         !is_invertible(DMat3(pose_.world_from_object[instance]));
}

/// Ids in the top level are indices of the scene's instances, whichever way a mesh went in.
void Builder::add(scene::Index index) {
  const scene::Instance& instance = scene_.instances[index];
  const scene::Mesh& mesh = scene_.meshes[instance.mesh];
  if (mesh.triangles.empty() || alpha_of(mesh) == AlphaUse::NeverThere) return;
  const DMat4& transform = pose_.world_from_object[index];
  const bool flat = goes_flat(index);
  const RTCGeometry geometry = flat ? new_triangles(instance.mesh, transform)
                                    : new_instance_of(child_of(instance.mesh), transform);
  state_.world_normal_from_embree[index] =
      flat ? flat_normal_matrix(DMat3(transform)) : Mat3(normal_matrix(DMat3(transform)));
  rtcAttachGeometryByID(state_.top, geometry, index);
  rtcReleaseGeometry(geometry);
}

void Builder::build() {
  for (const scene::Instance& instance : scene_.instances) ++uses_[instance.mesh];
  state_.world_normal_from_embree.assign(scene_.instances.size(), Mat3(1.0F));
  state_.top = new_scene();
  for (scene::Index i = 0; i < scene_.instances.size(); ++i) add(i);
  for (const auto& [mesh, child] : children_) rtcReleaseScene(child);  // the instances hold them
  rtcCommitScene(state_.top);
}

void keep_first_error(void* user, RTCError, const char* text) {
  auto& error = static_cast<SceneState*>(user)->device_error;
  if (error.empty()) error = text == nullptr || *text == '\0' ? "unknown error" : text;
}

int packet_width(RTCDevice device, PacketWidth wanted) {
  switch (wanted) {
    case PacketWidth::One:
      return 1;
    case PacketWidth::Eight:
      return 8;
    case PacketWidth::Sixteen:
      return 16;
    case PacketWidth::Device:
      break;
  }
  return rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0 ? 16 : 8;
}

Result<void> check_transforms(const scene::Scene& scene, const scene::ScenePose& pose) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (!is_finite(pose.world_from_object[i])) {
      return base::bad_input("the transform is not finite",
                             scene.name + ", instance " + std::to_string(i),
                             "every entry of world_from_object must be a finite number");
    }
  }
  return {};
}

}  // namespace

Result<std::shared_ptr<const TriangleScene>> TriangleScene::create(const scene::Scene& scene,
                                                                   const Options& options) {
  return create(scene, scene::pose_at(scene, {}), options);
}

Result<std::shared_ptr<const TriangleScene>> TriangleScene::create(const scene::Scene& scene,
                                                                   const scene::ScenePose& pose,
                                                                   const Options& options) {
  if (const auto checked = check_transforms(scene, pose); !checked) return base::forward(checked);
  auto state = std::make_unique<SceneState>();
  const bool wanted = options.bvh == scene::StepUse::Forced ||
                      (options.bvh == scene::StepUse::Used && !scene.instances.empty());
  if (!wanted) return std::shared_ptr<const TriangleScene>(new TriangleScene(std::move(state)));
  state->device = rtcNewDevice(nullptr);
  if (state->device == nullptr) {
    return base::runtime_error(
        "Embree's device cannot be made, code " + std::to_string(rtcGetDeviceError(nullptr)),
        scene.name, "Embree needs SSE2 and the memory of one small device");
  }
  rtcSetDeviceErrorFunction(state->device, keep_first_error, state.get());
  state->packet_width = visibility::packet_width(state->device, options.packets);
  state->scatters =
      options.packets == PacketWidth::Device && scene.triangle_count() >= kLeastForStreams;
  Builder(scene, pose, options, *state).build();
  if (!state->device_error.empty()) {
    return base::runtime_error("Embree cannot build the scene: " + state->device_error, scene.name,
                               "free memory or use a scene with fewer triangles");
  }
  return std::shared_ptr<const TriangleScene>(new TriangleScene(std::move(state)));
}

TriangleScene::TriangleScene(std::unique_ptr<SceneState> state) : state_(std::move(state)) {}
TriangleScene::~TriangleScene() = default;
int TriangleScene::packet_width() const {
  return state_->packet_width;
}

}  // namespace macula::visibility
