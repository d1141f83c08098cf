#include "server/visibility/moving_triangles.h"

#include <algorithm>
#include <utility>

#include "server/visibility/builder.h"
#include "shared/base/check.h"

namespace macula::visibility {
namespace {

/// New vertices under the same triangles; the child's boxes follow.
void refit(const Reshaped& reshaped, std::span<const Vec3> positions) {
  auto* vertices =
      static_cast<float*>(rtcGetGeometryBufferData(reshaped.geometry, RTC_BUFFER_TYPE_VERTEX, 0));
  if (vertices == nullptr) return;  // was out of memory: reported by the device
  for (const Vec3& p : positions) {
    *vertices++ = p.x, *vertices++ = p.y, *vertices++ = p.z;
  }
  rtcUpdateGeometryBuffer(reshaped.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(reshaped.geometry);
  rtcCommitScene(reshaped.child.get());
}

void move_instance(MovedInstance& moved, const DMat4& transform, Mat3& world_normal) {
  const bool there = is_finite(transform) && is_invertible(DMat3(transform));
  if (there != std::exchange(moved.enabled, there)) {
    there ? rtcEnableGeometry(moved.geometry) : rtcDisableGeometry(moved.geometry);
  }
  if (!there) return;
  world_normal = Mat3(normal_matrix(DMat3(transform)));
  set_transform(moved.geometry, transform);
}

}  // namespace

struct MovingTriangles::Still {
  const scene::Scene& scene;
  const scene::MovingParts moving;
  const Options options;
  std::shared_ptr<DeviceState> device;  ///< none: nothing is built
  Builder builder;
  std::unique_ptr<SceneState> pattern;  ///< how to trace, and the normals of what stands still
  SceneHandle flat;                     ///< by their triangles; none: nothing
  std::vector<scene::Index> shared;     ///< instances of the builder's children
  scene::ScenePose pose;                ///< where those stand; no lights, no cameras

  void build_flat(const scene::ScenePose& at);
  void refit_flat(const std::vector<RTCGeometry>& geometries) const;
  Reshaped new_reshaped(scene::Index mesh);
  RTCScene child_of_moving(scene::Index instance, const SceneState& state);
};

/// Everything that moves nowhere: its triangles in one scene, or by instances of shared meshes.
void MovingTriangles::Still::build_flat(const scene::ScenePose& at) {
  pose.world_from_object = at.world_from_object;
  pose.shapes = at.shapes;
  const Change change =
      options.refit == scene::StepUse::Forced ? Change::Vertices : Change::Nothing;
  flat = builder.new_scene(change);
  std::vector<RTCGeometry> geometries;
  for (scene::Index i = 0; i < scene.instances.size(); ++i) {
    if (std::ranges::binary_search(moving.instances, i) || !builder.is_there(i)) continue;
    if (!builder.goes_flat(i, pose.world_from_object[i])) {
      shared.push_back(i);
      continue;
    }
    geometries.push_back(builder.add_flat(i, pose, flat.get(), *pattern, change));
  }
  rtcCommitScene(flat.get());
  if (change == Change::Vertices) refit_flat(geometries);
  if (geometries.empty()) flat.reset();
}

void MovingTriangles::Still::refit_flat(const std::vector<RTCGeometry>& geometries) const {
  for (const RTCGeometry geometry : geometries) {
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
  }
  rtcCommitScene(flat.get());
}

/// The tree is built over the shape at rest; only refits follow.
Reshaped MovingTriangles::Still::new_reshaped(scene::Index mesh) {
  Reshaped made{mesh, builder.new_scene(Change::Vertices), nullptr};
  made.geometry =
      builder.new_triangles(mesh, scene.meshes[mesh].positions, DMat4(1.0), Change::Vertices);
  rtcAttachGeometry(made.child.get(), made.geometry);
  rtcReleaseGeometry(made.geometry);
  rtcCommitScene(made.child.get());
  return made;
}

RTCScene MovingTriangles::Still::child_of_moving(scene::Index instance, const SceneState& state) {
  const scene::Index mesh = scene.instances[instance].mesh;
  const auto reshaped = std::ranges::find(state.reshaped, mesh, &Reshaped::mesh);
  return reshaped != state.reshaped.end() ? reshaped->child.get() : builder.child_of(mesh, pose);
}

Result<std::unique_ptr<MovingTriangles>> MovingTriangles::create(const scene::Scene& scene,
                                                                 const scene::MovingParts& moving,
                                                                 const scene::ScenePose& pose,
                                                                 const Options& options) {
  if (const auto checked = check_transforms(scene, pose); !checked) return base::forward(checked);
  auto device = std::make_shared<DeviceState>();
  const bool wanted = wants_bvh(scene, options);
  if (wanted) {
    auto made = DeviceState::create(scene.name);
    if (!made) return base::forward(made);
    device = std::move(*made);
  }
  auto still = std::unique_ptr<Still>(new Still{
      scene, moving, options, device, Builder(scene, options, *device), nullptr, nullptr, {}, {}});
  if (wanted) {
    still->pattern = new_state(scene, options, device);
    still->build_flat(pose);
    if (const auto good = device->check(scene.name); !good) return base::forward(good);
  }
  return std::unique_ptr<MovingTriangles>(new MovingTriangles(std::move(still)));
}

MovingTriangles::MovingTriangles(std::unique_ptr<Still> still) : still_(std::move(still)) {}
MovingTriangles::~MovingTriangles() = default;

Result<std::shared_ptr<TriangleScene>> MovingTriangles::make(const scene::ScenePose& pose) {
  using Made = std::shared_ptr<TriangleScene>;
  Still& still = *still_;
  if (still.pattern == nullptr) return Made(new TriangleScene(std::make_unique<SceneState>()));
  auto state = new_state(still.scene, still.options, still.device);
  state->world_normal_from_embree = still.pattern->world_normal_from_embree;
  state->top = still.builder.new_scene(Change::Instances);
  for (const scene::Index mesh : still.moving.meshes)
    if (!still.scene.meshes[mesh].triangles.empty())
      state->reshaped.push_back(still.new_reshaped(mesh));
  if (still.flat != nullptr) {
    state->still_id = static_cast<std::uint32_t>(still.scene.instances.size());
    still.builder.add_instance(state->still_id, still.flat.get(), DMat4(1.0), *state);
  }
  for (const scene::Index i : still.shared) {
    const RTCScene child = still.builder.child_of(still.scene.instances[i].mesh, still.pose);
    still.builder.add_instance(i, child, still.pose.world_from_object[i], *state);
  }
  for (const scene::Index i : still.moving.instances) {
    if (!still.builder.is_there(i)) continue;
    const RTCScene child = still.child_of_moving(i, *state);
    state->moved.push_back({i, still.builder.add_instance(i, child, DMat4(1.0), *state)});
  }
  state->triangles_kept = still.builder.triangles_made();
  Made made(new TriangleScene(std::move(state)));
  if (const auto moved = move(*made, pose); !moved) return base::forward(moved);
  return made;
}

Result<void> MovingTriangles::move(TriangleScene& triangles, const scene::ScenePose& pose) const {
  SceneState& state = *triangles.state_;
  if (state.top == nullptr) return {};
  for (const Reshaped& reshaped : state.reshaped)
    refit(reshaped, pose.positions(still_->scene, reshaped.mesh));
  for (MovedInstance& moved : state.moved)
    move_instance(moved, pose.world_from_object[moved.instance],
                  state.world_normal_from_embree[moved.instance]);
  rtcCommitScene(state.top.get());
  return state.device->check(still_->scene.name);
}

}  // namespace macula::visibility
