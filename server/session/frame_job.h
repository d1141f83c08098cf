// One frame on its way through the server's stages. Two jobs circulate, so that one renders while
// the other encodes; their buffers keep their memory. Owned by one stage at a time.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/disocclusion/hidden_layer.h"
#include "server/kernels/frame_buffers.h"
#include "server/kernels/kernel.h"
#include "server/session/actions.h"
#include "server/session/encode_memory.h"
#include "server/session/view_builder.h"

namespace macula::session {

/// What rendering remembers of one epoch of a session.
struct RenderMemory {
  std::uint32_t epoch = 0;
  kernels::History history;
  bool history_is_torn = true;  ///< before the first frame, and after one that was stopped half way
  std::uint32_t ladder_step = 0;  ///< that history was made with
  GazeFilters gaze;
  /// The encode thread's own; nobody else looks inside.
  std::shared_ptr<EncodeMemory> encode = std::make_shared<EncodeMemory>();
};

struct FrameJob {
  StartFrame start;
  std::shared_ptr<EncodeMemory> encode_memory;
  std::vector<kernels::View> views;
  kernels::FrameBuffers buffers;
  kernels::FrameReport report;
  /// By view, where start.view_cell_m is above 0.
  std::vector<disocclusion::HiddenLayer> hidden;
  std::size_t cells = 0;
  foveation::RateModel rate_model;
  Degrees guard_band{0.0};
  double scale = 1.0;              ///< of the nominal display, by the governor
  std::optional<SpotError> error;  ///< of frames that are judged
  kernels::SceneTime scene_time;
  bool starts_history = false;  ///< it remembers no frame before it
  /// render_end is encode_begin: waiting for the encoder belongs to the encode stage.
  ServerTime render_begin{}, render_end{}, encode_end{};
  EncodedSize encoded;
  Nanoseconds encode_cpu{0};  ///< over all eyes
};

}  // namespace macula::session
