// SceneState: what a TriangleScene holds. Internal to this room; build.cpp fills it, query.cpp
// reads it.
#pragma once

#include <string>
#include <vector>

#include "server/visibility/alpha_test.h"
#include "server/visibility/embree.h"

namespace macula::visibility {

struct SceneState {
  SceneState() = default;
  SceneState(const SceneState&) = delete;
  SceneState& operator=(const SceneState&) = delete;
  ~SceneState() {
    if (top != nullptr) rtcReleaseScene(top);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  RTCDevice device = nullptr;
  RTCScene top = nullptr;  ///< geometry and instance ids are indices into Scene::instances
  int packet_width = 0;    ///< 0: no device, nothing to meet
  bool scatters = false;   ///< incoherent occlusion rays go as one stream, not in packets
  /// Geometric normal of Embree (object space, by winding) to the world, towards the front face.
  std::vector<Mat3> world_normal_from_embree;  ///< by instance
  std::vector<std::unique_ptr<const AlphaTest>> alpha_tests;
  std::string device_error;  ///< first message of the device during the build
};

}  // namespace macula::visibility
