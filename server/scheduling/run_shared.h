// run_shared: a pass whose tiles may run on other ranks. Where the frame is not shared it is
// TileScheduler::run.
#pragma once

#include <utility>

#include "server/scheduling/frame_sharing.h"
#include "server/scheduling/tile_scheduler.h"

namespace macula::scheduling {

/// body(index) for [0, count). places(): a TilePlace for each. outputs(index, parcel) names all
/// that a tile's body writes, for a parcel to carry; what it says may depend on the frame's request
/// and on what is already in the parcel, not on what bodies found. Tiles do not read what others of
/// the same pass write; parcels are unpacked on the scheduler's threads.
template <class Places, class Body, class Outputs>
Outcome run_shared(TileScheduler& scheduler, std::size_t count, Audience audience, Places&& places,
                   Body&& body, Outputs&& outputs) {
  FrameSharing* sharing = scheduler.sharing();
  if (sharing == nullptr) return scheduler.run(count, std::forward<Body>(body));
  const SharedPass pass{places(), audience};
  MACULA_CHECK(pass.tiles.size() == count, "every tile has its place");
  return sharing->run(scheduler, pass, body, outputs, scheduler.stop_token());
}

/// Places of tiles that lie nowhere in a picture.
inline auto nowhere(std::size_t count) {
  return [count] { return std::vector<TilePlace>(count); };
}
/// Places of `rows` rows of a view.
inline auto by_rows(std::size_t rows, std::size_t view = 0) {
  return [rows, view] {
    std::vector<TilePlace> places(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      places[row].view = static_cast<std::uint32_t>(view);
      places[row].at.y = (static_cast<float>(row) + 0.5F) / static_cast<float>(rows);
    }
    return places;
  };
}
/// The place of a rectangle of a picture of this size; its work is the number of its cells.
inline TilePlace place_of(const image::Rect& rect, int width, int height, std::size_t view = 0) {
  return {static_cast<std::uint32_t>(view),
          {(static_cast<float>(rect.x) + 0.5F * static_cast<float>(rect.width)) /
               static_cast<float>(width),
           (static_cast<float>(rect.y) + 0.5F * static_cast<float>(rect.height)) /
               static_cast<float>(height)},
          static_cast<float>(rect.width * rect.height)};
}

}  // namespace macula::scheduling
