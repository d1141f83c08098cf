// TileScheduler: runs the tiles of one pass on threads. Deterministic by construction: which thread
// runs a tile never reaches the tile's work. Checks its stop token before every tile, so a vanished
// client frees the threads within one tile. One caller at a time; a body may call run() again (the
// inner run shares the threads). Bodies do not throw. The only place that knows TBB.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <type_traits>

#include "server/scheduling/tsan.h"
#include "shared/image/plane.h"

namespace macula::scheduling {

enum class Outcome { Completed, Stopped };

class FrameSharing;

class TileScheduler {
 public:
  /// `threads` = 0 takes what the machine offers; the caller of run() is one of them. Tiles run
  /// with denormals flushed (FTZ + DAZ); the caller has its own setting back when run() returns.
  explicit TileScheduler(int threads = 0);
  ~TileScheduler();
  TileScheduler(const TileScheduler&) = delete;
  TileScheduler& operator=(const TileScheduler&) = delete;

  int threads() const;
  /// A stop request makes run() return Stopped after the tiles already begun.
  void set_stop_token(std::stop_token token);
  const std::stop_token& stop_token() const { return stop_; }

  /// Until share(nullptr), passes that can be (run_shared.h) are split among ranks. The others run
  /// to their end on every rank: where a frame stops, all ranks have to stop together.
  void share(FrameSharing* sharing) { sharing_ = sharing; }
  FrameSharing* sharing() const { return sharing_; }

  /// body(std::size_t index) for every index in [0, count), each exactly once unless stopped. What
  /// the bodies wrote is visible to the caller when run() returns.
  template <class Body>
  Outcome run(std::size_t count, Body&& body) {
    Call<std::remove_reference_t<Body>> call{&body, {}, {}};
    tsan::release(&call.fork);
    const Outcome outcome = run_erased(count, &call, &call.run_one);
    tsan::acquire(&call.join);
    return outcome;
  }
  /// body(image::Rect tile) over a picture, in tiles of at most side x side.
  template <class Body>
  Outcome run_tiles(int width, int height, int side, Body&& body) {
    const int columns = (width + side - 1) / side, rows = (height + side - 1) / side;
    return run(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
               [&](std::size_t index) {
                 const int x = static_cast<int>(index) % columns * side;
                 const int y = static_cast<int>(index) / columns * side;
                 body(image::Rect{x, y, x + side < width ? side : width - x,
                                  y + side < height ? side : height - y});
               });
  }

 private:
  /// One run() as run_erased sees it; fork and join are addresses for the thread sanitizer.
  template <class Body>
  struct Call {
    Body* body;
    std::uint64_t fork, join;

    static void run_one(void* context, std::size_t index) {
      auto& call = *static_cast<Call*>(context);
      tsan::acquire(&call.fork);
      (*call.body)(index);
      tsan::release(&call.join);
    }
  };

  Outcome run_erased(std::size_t count, void* context, void (*body)(void*, std::size_t));
  struct Arena;
  std::unique_ptr<Arena> arena_;
  std::stop_token stop_;
  FrameSharing* sharing_ = nullptr;
};

}  // namespace macula::scheduling
