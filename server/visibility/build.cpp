// From a Scene to Embree's two levels.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include "server/visibility/builder.h"
#include "server/visibility/device_count.h"

namespace macula::visibility {
namespace {

/// Meshes below this many triangles are copied per instance, where there is room: entering an
/// instance costs more than their share of the top level.
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

/// Embree takes the normal of moved vertices by their winding, which a mirroring transform turns.
Mat3 flat_normal_matrix(const DMat3& linear) {
  const double determinant = glm::dot(linear[0], glm::cross(linear[1], linear[2]));
  return Mat3(determinant < 0.0 ? -1.0F : 1.0F);
}

/// Embree's filter callback of masks: the surface is not there where alpha says so.
void mask_filter(const RTCFilterFunctionNArguments* call) {
  const AlphaTest& test = static_cast<const FilteredMesh*>(call->geometryUserPtr)->test;
  for (unsigned i = 0; i < call->N; ++i) {
    if (call->valid[i] != -1) continue;
    const float u = RTCHitN_u(call->hit, call->N, i), v = RTCHitN_v(call->hit, call->N, i);
    if (!test.is_there(RTCHitN_primID(call->hit, call->N, i), u, v)) call->valid[i] = 0;
  }
}

/// The same where rays decide, each by the BlendRule that it carries as its id.
void blend_filter(const RTCFilterFunctionNArguments* call) {
  const auto& mesh = *static_cast<const FilteredMesh*>(call->geometryUserPtr);
  const unsigned n = call->N;
  for (unsigned i = 0; i < n; ++i) {
    if (call->valid[i] != -1) continue;
    const std::uint32_t instance = instance_of(RTCHitN_instID(call->hit, n, i, 0),
                                               RTCHitN_geomID(call->hit, n, i), mesh.still_id);
    if (!mesh.test.is_there(RTCHitN_primID(call->hit, n, i), RTCHitN_u(call->hit, n, i),
                            RTCHitN_v(call->hit, n, i), RTCRayN_id(call->ray, n, i), instance)) {
      call->valid[i] = 0;
    }
  }
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

}  // namespace

// ---- the device ----

namespace {
std::atomic<std::uint64_t> made{0};
}  // namespace

std::uint64_t devices_made() {
  return made.load();
}

Result<std::shared_ptr<DeviceState>> DeviceState::create(const std::string& name) {
  auto state = std::make_shared<DeviceState>();
  state->device = rtcNewDevice(nullptr);
  ++made;
  if (state->device == nullptr) {
    return base::runtime_error(
        "Embree's device cannot be made, code " + std::to_string(rtcGetDeviceError(nullptr)), name,
        "Embree needs SSE2 and the memory of one small device");
  }
  rtcSetDeviceErrorFunction(state->device, keep_first_error, state.get());
  return state;
}

void DeviceState::keep_first_error(void* user, RTCError, const char* text) {
  auto& state = *static_cast<DeviceState*>(user);
  const std::lock_guard lock(state.mutex_);
  if (state.first_error_.empty())
    state.first_error_ = text == nullptr || *text == '\0' ? "unknown error" : text;
}

Result<void> DeviceState::check(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  if (first_error_.empty()) return {};
  return base::runtime_error("Embree cannot build the scene: " + first_error_, name,
                             "free memory or use a scene with fewer triangles");
}

// ---- transforms ----

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

/// |det| relative to the lengths of the columns: 1 for orthogonal, 0 for a collapsed transform.
bool is_invertible(const DMat3& linear) {
  constexpr double kLeastVolume = 1e-6;  // below it, float instance transforms lose all digits
  const double volume = std::abs(glm::dot(linear[0], glm::cross(linear[1], linear[2])));
  const double box = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return box > 0.0 && volume > kLeastVolume * box;
}

void set_transform(RTCGeometry instance, const DMat4& transform) {
  float columns[12];
  for (int i = 0; i < 12; ++i) columns[i] = static_cast<float>(transform[i / 3][i % 3]);
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(instance);
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

// ---- meshes and instances ----

Builder::Builder(const scene::Scene& scene, const Options& options, DeviceState& device)
    : scene_(scene),
      options_(options),
      device_(device),
      all_flat_(scene.triangle_count() <= options.flat_triangles),
      copied_(scene.meshes.size(), false) {
  std::vector<std::size_t> uses(scene.meshes.size(), 0);
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh];
  choose_copied(uses);
}

/// Meshes with one instance; of the others the small ones, from the smallest on, whose gain is
/// largest, while their copies together stay within a scene that would be all flat.
void Builder::choose_copied(const std::vector<std::size_t>& uses) {
  const auto size = [this](scene::Index mesh) { return scene_.meshes[mesh].triangles.size(); };
  std::vector<scene::Index> small;
  for (scene::Index mesh = 0; mesh < uses.size(); ++mesh) {
    copied_[mesh] = uses[mesh] < 2;
    if (!copied_[mesh] && size(mesh) < kFewTriangles) small.push_back(mesh);
  }
  std::ranges::stable_sort(small, {}, size);
  std::size_t left = options_.flat_triangles;
  for (const scene::Index mesh : small) {
    const std::size_t copies = uses[mesh] * size(mesh);
    copied_[mesh] = copies <= left;
    if (copied_[mesh]) left -= copies;
  }
}

/// Only a scene of low quality keeps a tree for each geometry, which can be refitted; the trees
/// themselves are built by surface area all the same. A tree over instances is best built whole.
SceneHandle Builder::new_scene(Change change) const {
  SceneHandle made(rtcNewScene(device_.device));
  unsigned flags = RTC_SCENE_FLAG_NONE;
  if (options_.edges == EdgeTest::Robust) flags |= RTC_SCENE_FLAG_ROBUST;
  if (change != Change::Nothing) flags |= RTC_SCENE_FLAG_DYNAMIC;
  rtcSetSceneFlags(made.get(), static_cast<RTCSceneFlags>(flags));
  rtcSetSceneBuildQuality(made.get(), change == Change::Vertices ? RTC_BUILD_QUALITY_LOW
                                                                 : build_quality(options_.quality));
  return made;
}

AlphaUse Builder::alpha_of(const scene::Mesh& mesh) const {
  if (options_.alpha_test == scene::StepUse::LeftOut) return AlphaUse::AlwaysThere;
  const AlphaUse use = alpha_use(scene_, mesh);
  const bool forced = options_.alpha_test == scene::StepUse::Forced;
  return forced && use == AlphaUse::AlwaysThere ? AlphaUse::PerPoint : use;
}

FilteredMesh& Builder::filtered(scene::Index mesh) {
  const auto known = device_.filtered.find(mesh);
  if (known != device_.filtered.end()) return known->second;
  const auto still_id = static_cast<std::uint32_t>(scene_.instances.size());
  FilteredMesh made{AlphaTest(scene_, scene_.meshes[mesh]), still_id};
  return device_.filtered.emplace(mesh, std::move(made)).first->second;
}

RTCGeometry Builder::new_triangles(scene::Index mesh_index, std::span<const Vec3> positions,
                                   const DMat4& transform, Change change) {
  const scene::Mesh& mesh = scene_.meshes[mesh_index];
  triangles_made_ += mesh.triangles.size();
  const RTCGeometry geometry = rtcNewGeometry(device_.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, change == Change::Vertices
                                           ? RTC_BUILD_QUALITY_REFIT
                                           : build_quality(options_.quality));
  copy_vertices(geometry, positions, transform);
  copy_triangles(geometry, mesh);
  if (alpha_of(mesh) == AlphaUse::PerPoint) {
    FilteredMesh& asked = filtered(mesh_index);
    const RTCFilterFunctionN filter = asked.test.blends() ? blend_filter : mask_filter;
    rtcSetGeometryUserData(geometry, &asked);
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcSetGeometryOccludedFilterFunction(geometry, filter);
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCScene Builder::child_of(scene::Index mesh, const scene::ScenePose& pose) {
  SceneHandle& child = children_[mesh];
  if (child == nullptr) {
    child = new_scene();
    const RTCGeometry geometry =
        new_triangles(mesh, pose.positions(scene_, mesh), DMat4(1.0), Change::Nothing);
    rtcAttachGeometry(child.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(child.get());
  }
  return child.get();
}

bool Builder::is_there(scene::Index instance) const {
  const scene::Mesh& mesh = scene_.meshes[scene_.instances[instance].mesh];
  return !mesh.triangles.empty() && alpha_of(mesh) != AlphaUse::NeverThere;
}

bool Builder::goes_flat(scene::Index instance, const DMat4& world_from_object) const {
  const scene::Index mesh = scene_.instances[instance].mesh;
  return all_flat_ || copied_[mesh] || !is_invertible(DMat3(world_from_object));
}

RTCGeometry Builder::add_flat(scene::Index index, const scene::ScenePose& pose, RTCScene into,
                              SceneState& state, Change change) {
  const scene::Index mesh = scene_.instances[index].mesh;
  const DMat4& transform = pose.world_from_object[index];
  const RTCGeometry geometry = new_triangles(mesh, pose.positions(scene_, mesh), transform, change);
  state.world_normal_from_embree[index] = flat_normal_matrix(DMat3(transform));
  rtcAttachGeometryByID(into, geometry, index);
  rtcReleaseGeometry(geometry);
  return geometry;
}

RTCGeometry Builder::add_instance(scene::Index index, RTCScene child, const DMat4& transform,
                                  SceneState& state) const {
  const RTCGeometry geometry = rtcNewGeometry(device_.device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, child);
  rtcSetGeometryTimeStepCount(geometry, 1);
  set_transform(geometry, transform);
  if (index < state.world_normal_from_embree.size())
    state.world_normal_from_embree[index] = Mat3(normal_matrix(DMat3(transform)));
  rtcAttachGeometryByID(state.top.get(), geometry, index);
  rtcReleaseGeometry(geometry);
  state.has_instances = true;
  return geometry;
}

std::unique_ptr<SceneState> new_state(const scene::Scene& scene, const Options& options,
                                      std::shared_ptr<const DeviceState> device) {
  auto state = std::make_unique<SceneState>();
  state->packet_width = packet_width(device->device, options.packets);
  state->scatters =
      options.packets == PacketWidth::Device && scene.triangle_count() >= kLeastForStreams;
  state->blends = options.alpha_test != scene::StepUse::LeftOut &&
                  std::ranges::any_of(scene.meshes, [&scene](const scene::Mesh& mesh) {
                    return blends(scene, mesh);
                  });
  state->world_normal_from_embree.assign(scene.instances.size(), Mat3(1.0F));
  state->device = std::move(device);
  return state;
}

bool wants_bvh(const scene::Scene& scene, const Options& options) {
  return options.bvh == scene::StepUse::Forced ||
         (options.bvh == scene::StepUse::Used && !scene.instances.empty());
}

// ---- a scene that stays as it is ----

Result<std::shared_ptr<const TriangleScene>> TriangleScene::create(const scene::Scene& scene,
                                                                   const Options& options) {
  return create(scene, scene::pose_at(scene, {}), options);
}

Result<std::shared_ptr<const TriangleScene>> TriangleScene::create(const scene::Scene& scene,
                                                                   const scene::ScenePose& pose,
                                                                   const Options& options) {
  using Made = std::shared_ptr<const TriangleScene>;
  if (const auto checked = check_transforms(scene, pose); !checked) return base::forward(checked);
  if (!wants_bvh(scene, options)) return Made(new TriangleScene(std::make_unique<SceneState>()));
  auto device = DeviceState::create(scene.name);
  if (!device) return base::forward(device);
  auto state = new_state(scene, options, *device);
  Builder builder(scene, options, **device);
  state->top = builder.new_scene();
  for (scene::Index i = 0; i < scene.instances.size(); ++i) {
    if (!builder.is_there(i)) continue;
    const DMat4& transform = pose.world_from_object[i];
    if (builder.goes_flat(i, transform)) {
      builder.add_flat(i, pose, state->top.get(), *state);
    } else {
      builder.add_instance(i, builder.child_of(scene.instances[i].mesh, pose), transform, *state);
    }
  }
  rtcCommitScene(state->top.get());
  state->triangles_kept = builder.triangles_made();
  if (const auto good = (*device)->check(scene.name); !good) return base::forward(good);
  return Made(new TriangleScene(std::move(state)));
}

TriangleScene::TriangleScene(std::unique_ptr<SceneState> state) : state_(std::move(state)) {}
TriangleScene::~TriangleScene() = default;
bool TriangleScene::has_device() const {
  return state_->device != nullptr;
}
bool TriangleScene::blends() const {
  return state_->blends;
}
std::size_t TriangleScene::triangles_kept() const {
  return state_->triangles_kept;
}
int TriangleScene::packet_width() const {
  return state_->packet_width;
}

}  // namespace macula::visibility
