// ClientReport: what a run of the client measured, and its JSON. Times in ms with the unit in the
// key; quantiles are linear between neighbours. Stage times are of the first showing of every
// server frame whose stamps are whole; ages are of every shown frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/frames/stage_book.h"
#include "client/frames/statistics.h"
#include "shared/base/result.h"
#include "shared/net/client_endpoint.h"

namespace macula::display {

/// Which end a run came to.
enum class RunEnd {
  FramesShown,
  PosesEnded,
  WindowClosed,
  HeadsetClosed,  ///< its runtime ended the session
  HeadsetLost,    ///< its runtime is gone
  Interrupted,
  ServerSilent
};
const char* name(RunEnd end);

struct ClientReport {
  RunEnd ended = RunEnd::FramesShown;
  double duration_s = 0.0;
  std::uint64_t shown_frames = 0;
  std::uint64_t distinct_server_frames = 0;
  std::uint64_t frames_out_of_order = 0;        ///< shown after a newer one: always 0
  std::uint64_t refreshes_without_picture = 0;  ///< before the first frame
  std::uint64_t refreshes_missed = 0;           ///< the loop was too late for them
  std::uint64_t frames_undecodable = 0;
  std::uint64_t gaze_changes_over_10_deg = 0;
  frames::Ages ages;
  std::vector<frames::AccountedFrame> accounts;  ///< the newest
  std::uint64_t accounts_left_out = 0;           ///< older ones of a long run
  std::uint64_t accounts_incomplete = 0;
  frames::Series filled_share, outside_share;           ///< of a shown eye's pixels
  frames::Series frame_bytes, frame_cells, frame_rays;  ///< of distinct server frames
  frames::Series bound_p95_px, bound_most_px;           ///< of these: reprojection::ErrorBound
  frames::Series hidden_cells, hidden_bytes;            ///< of these, of their second layer
  std::optional<net::ClockEstimate> clock;
  net::ClientCounters network;
  std::optional<net::Welcome> welcome;
  std::uint64_t pictures_written = 0, pictures_skipped = 0;
  std::vector<std::pair<std::string, std::string>> config;  ///< in force, by option

  /// Of one stage over all accounts.
  frames::Series stage_ms(frames::Stage stage) const;
};

std::string to_json(const ClientReport& report);
/// A row for every account: epoch, frame, each stage, unattributed and total, in ms.
std::string frames_csv(const ClientReport& report);
/// report.json and frames.csv into a folder. Errors name the file.
Result<void> write_reports(const std::string& folder, const ClientReport& report);
/// A few lines for the terminal.
std::string summary(const ClientReport& report);

}  // namespace macula::display
