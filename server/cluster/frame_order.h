// FrameOrder: all that a rank needs to make the same frame as rank 0: the request, which kernel,
// which history, which moment of the scene. Ranks hold the same scene, kernels and settings; only
// this travels.
#pragma once

#include <cstdint>
#include <vector>

#include "server/kernels/kernel.h"
#include "server/scheduling/parcel.h"
#include "server/scheduling/rank_group.h"

namespace macula::cluster {

struct FrameOrder {
  bool ends = false;         ///< no more frames; nothing else counts
  std::uint32_t kernel = 0;  ///< index into the kernels that every rank has
  std::uint64_t history = 0;
  std::vector<std::uint64_t> forgotten;  ///< histories that rank 0 has no more
  kernels::SceneTime scene_time{};
  std::uint64_t frame = 0, seed = 0;
  unsigned wanted = 0;   ///< PlaneFlag bits
  bool watched = false;  ///< ranks tell what everything cost, for measurements
  std::vector<kernels::View> views;
  std::vector<FoveationMap::ViewInput> foveation;
  foveation::RateModel model;

  void carry(scheduling::Parcel& parcel);
  scheduling::Bytes bytes() const;
  static FrameOrder from(const scheduling::Bytes& bytes);
};

}  // namespace macula::cluster
