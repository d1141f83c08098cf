// What a TriangleScene holds. Internal to this room; build.cpp and moving_triangles.cpp fill it,
// query.cpp reads it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

#include "server/visibility/alpha_test.h"
#include "server/visibility/embree.h"

namespace macula::visibility {

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// What the filters of a mesh's geometries ask.
struct FilteredMesh {
  AlphaTest test;
  std::uint32_t still_id;  ///< as in SceneState
};

/// Embree's device and what its structures point at; outlives all of them.
class DeviceState {
 public:
  /// Errors: the device cannot be made. `name` of the scene is for messages.
  static Result<std::shared_ptr<DeviceState>> create(const std::string& name);
  DeviceState() = default;
  DeviceState(const DeviceState&) = delete;
  DeviceState& operator=(const DeviceState&) = delete;
  ~DeviceState() {
    if (device != nullptr) rtcReleaseDevice(device);
  }
  /// Whether the device has complained since it was made.
  Result<void> check(const std::string& name) const;

  RTCDevice device = nullptr;
  std::map<scene::Index, FilteredMesh> filtered;  ///< by mesh; where they lie in memory stays

 private:
  static void keep_first_error(void* user, RTCError code, const char* text);
  mutable std::mutex mutex_;
  std::string first_error_;
};

/// An instance whose transform changes: its own object in the top level.
struct MovedInstance {
  scene::Index instance = 0;
  RTCGeometry geometry = nullptr;  ///< held by the top level
  bool enabled = true;
};

/// A mesh whose vertices change: a scene below the top level that is refitted.
struct Reshaped {
  scene::Index mesh = 0;
  SceneHandle child;
  RTCGeometry geometry = nullptr;  ///< held by the child
};

/// Index into Scene::instances of what Embree names by an instance of the top level (or
/// RTC_INVALID_GEOMETRY_ID) and a geometry. `still_id` stands for all instances by their triangles.
inline std::uint32_t instance_of(std::uint32_t outer, std::uint32_t geometry,
                                 std::uint32_t still_id) {
  return outer == RTC_INVALID_GEOMETRY_ID || outer == still_id ? geometry : outer;
}

struct SceneState {
  std::shared_ptr<const DeviceState> device;  ///< none: nothing to meet
  SceneHandle top;  ///< geometry and instance ids are indices into Scene::instances
  /// Id of the one instance that stands for all that never moves; its geometries have the indices.
  std::uint32_t still_id = RTC_INVALID_GEOMETRY_ID;  ///< always Scene::instances.size()
  std::size_t triangles_kept = 0;
  int packet_width = 0;  ///< 0: no device
  bool has_instances = false;
  bool scatters = false;  ///< incoherent occlusion rays go as one stream, not in packets
  bool blends = false;    ///< rays carry their BlendRule as Embree's ray id
  /// Geometric normal of Embree (object space, by winding) to the world, towards the front face.
  std::vector<Mat3> world_normal_from_embree;  ///< by instance
  std::vector<MovedInstance> moved;
  std::vector<Reshaped> reshaped;
};

}  // namespace macula::visibility
