// Where a node stands in its parent at one moment. Inside server/sdf.
#pragma once

#include "server/sdf/field.h"

namespace macula::sdf {

/// parent = at + scale * rotation * own.
struct Placement {
  DVec3 at{0.0};
  DMat3 rotation{1.0};
  double scale = 1.0;
  bool turned = false;  ///< rotation is not the identity
};

inline Placement placement_of(const Field& field, const Node& node, double time_s) {
  Placement placement;
  placement.at = field.at(node.at, time_s);
  placement.scale = field.at(node.scale, time_s).x;
  const DVec3 turns = glm::radians(field.at(node.rotate_deg, time_s));
  if (turns == DVec3{0.0}) return placement;
  placement.turned = true;
  const DQuat rotation = glm::angleAxis(turns.z, DVec3{0.0, 0.0, 1.0}) *
                         glm::angleAxis(turns.y, DVec3{0.0, 1.0, 0.0}) *
                         glm::angleAxis(turns.x, DVec3{1.0, 0.0, 0.0});
  placement.rotation = glm::mat3_cast(rotation);
  return placement;
}

}  // namespace macula::sdf
