// A frame on a cluster that is not there: the tiles of a frame that was measured on one rank, with
// their costs and the bytes they leave behind, handed out to any number of ranks by the server's
// own rules, and sent over links of a stated latency and bandwidth. Pure.
#pragma once

#include <vector>

#include "server/scheduling/balance.h"
#include "server/scheduling/frame_sharing.h"

namespace macula::bench {

/// One frame as one rank made it on one thread.
struct FrameTrace {
  std::vector<scheduling::PassRecord> passes;
  double alone_ms = 0.0;     ///< what every rank does for itself, on one thread
  double threaded_ms = 0.0;  ///< the same, on all threads of a rank
};

struct ClusterSpec {
  int ranks = 1, threads = 1;        ///< threads of each rank
  double latency_ms = 0.005;         ///< of one message
  double message_ms = 0.001;         ///< of a rank's time for each that it sends and gets
  double bytes_per_ms = 3.125e6;     ///< of a rank's link, each way (25 Gbit/s)
  double copied_bytes_per_ms = 2e6;  ///< into and out of messages, by a thread: one packs, and
                                     ///< unpacks rows; tiles are unpacked by all
};

struct ModelledFrame {
  double frame_ms = 0.0;
  double tiles_ms = 0.0;     ///< of the slowest rank of each pass
  double alone_ms = 0.0;     ///< what every rank does for itself
  double copy_ms = 0.0;      ///< into and out of messages
  double transfer_ms = 0.0;  ///< latencies and bytes on the links
  double comm_bytes = 0.0;   ///< that all links carry
  double imbalance = 1.0;    ///< slowest rank over the mean, weighted by time
};

/// Every rank has a link of its own. A pass ends when its slowest rank has: everybody sends
/// everybody what its tiles cost, and what they leave (each link carries all others' bytes once),
/// or that to rank 0 alone. A step over rows is split into equal bands; each rank gets the rows
/// around its own that the next step reads, where need be after all have told which.
ModelledFrame model_frame(const FrameTrace& trace, const ClusterSpec& spec,
                          scheduling::Balance balance);

}  // namespace macula::bench
