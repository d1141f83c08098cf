#include "server/cluster/frame_order.h"

namespace macula::cluster {
namespace {

using scheduling::Parcel;

void carry(PixelGrid& grid, Parcel& parcel) {
  parcel.vector(grid.x_edges);
  parcel.vector(grid.y_edges);
}

/// body(element) for every element, their number first.
template <class T, class Body>
void each(std::vector<T>& elements, Parcel& parcel, const Body& body) {
  auto count = elements.size();
  parcel.value(count);
  elements.resize(count);
  for (T& element : elements) body(element);
}

}  // namespace

void FrameOrder::carry(Parcel& parcel) {
  parcel.value(ends), parcel.value(kernel), parcel.value(history);
  parcel.vector(forgotten);
  parcel.value(scene_time), parcel.value(frame), parcel.value(seed), parcel.value(wanted);
  parcel.value(watched);
  each(views, parcel, [&](kernels::View& view) {
    parcel.value(view.world_from_view);
    cluster::carry(view.grid, parcel);
    parcel.value(view.gaze), parcel.value(view.tone);
  });
  each(foveation, parcel, [&](FoveationMap::ViewInput& input) {
    cluster::carry(input.grid, parcel);
    parcel.value(input.gaze), parcel.value(input.nominal_pixel_tangent);
  });
  parcel.value(model);
}

scheduling::Bytes FrameOrder::bytes() const {
  scheduling::Bytes bytes;
  Parcel parcel = Parcel::packing(bytes);
  FrameOrder copy = *this;  // a parcel's description serves both ways
  copy.carry(parcel);
  return bytes;
}

FrameOrder FrameOrder::from(const scheduling::Bytes& bytes) {
  FrameOrder order;
  Parcel parcel = Parcel::unpacking(bytes);
  order.carry(parcel);
  return order;
}

}  // namespace macula::cluster
