// Puts frames together on the client. A pure state machine: slices must come in directory order
// without gap or overlap (the wire is TCP), whatever else comes discards the frame, and a discarded
// frame is acknowledged like a received one, so that its credit returns. Memory grows with the
// bytes that came, never with sizes that were merely announced.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "shared/net/client_endpoint.h"
#include "shared/net/messages.h"

namespace macula::net {

class FrameAssembler {
 public:
  /// What a message did to the frame now arriving.
  enum class Step {
    Ignored,  ///< of another epoch, of a frame already acknowledged, or of none that is known
    Advanced,
    Discarded,  ///< the frame (or the one before it) is given up: acknowledge now
    Completed,  ///< take() has a frame: acknowledge now
  };

  explicit FrameAssembler(const Limits& limits) : limits_(limits) {}

  /// A new connection or epoch: forgets what is unfinished, uncounted, and starts acknowledging
  /// anew.
  void start_epoch(std::uint32_t epoch);

  /// `begin` has passed check_frame_begin. Grids that it leaves out are filled in; one that leans
  /// on a grid that never came is discarded.
  Step begin(FrameBegin begin, ClientTime now);
  Step slice(const SliceHeader& header, std::span<const std::byte> bytes);
  Step end(const FrameEnd& end, ClientTime now);

  /// The rest of the frame now arriving will not come.
  Step give_up() { return arriving_ ? discard() : Step::Ignored; }

  /// A frame is missing that later ones lean on: says so until a key frame is complete.
  void want_key() { acks_.need_key = true; }

  /// The frame that the last Completed step finished.
  std::optional<ReceivedFrame> take();

  const Acks& acks() const { return acks_; }
  bool is_receiving() const { return arriving_.has_value(); }
  /// Frames begun and discarded since construction.
  std::uint64_t incomplete() const { return incomplete_; }

 private:
  /// Whether `frame` is of this epoch and newer than all begun: its FrameBegin was refused.
  bool is_beyond(std::uint32_t epoch, std::uint64_t frame) const;
  Step skip_to(std::uint64_t frame);
  /// Fills in what `begin` leaves out, and remembers what it brings.
  bool know_grids(FrameBegin& begin);
  bool fits(const SliceHeader& header, std::size_t size) const;
  bool all_slices_came() const;
  Step discard();

  const Limits limits_;
  Acks acks_;
  std::optional<ReceivedFrame> arriving_;
  std::size_t next_slice_ = 0;  ///< directory entry that the next bytes belong to
  std::optional<ReceivedFrame> complete_;
  std::uint64_t grid_frame_ = 0;  ///< the last frame of this epoch that brought grids
  std::vector<PixelGrid> grids_;  ///< its, by eye
  std::uint64_t incomplete_ = 0;
};

}  // namespace macula::net
