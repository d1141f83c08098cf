// Vitals: the last second of a run, as a watcher of the window wants to see it. One thread.
#pragma once

#include <deque>
#include <string>

#include "client/app/run_log.h"
#include "client/display/window/dashboard.h"
#include "shared/net/client_endpoint.h"

namespace macula::client_app {

class Vitals {
 public:
  /// After `log` has noted it.
  void note(const Showing& showing, const RunLog& log, const net::ClientEndpoint& endpoint);
  const display::Dashboard& dashboard() const { return dashboard_; }

 private:
  struct Refresh {
    ClientTime shown;
    std::uint64_t bytes;  ///< received until then
    bool new_frame;
  };
  void note_columns(const frames::StageBook& book);
  std::string bound_line(const Showing& showing);
  void write_lines(const Showing& showing, const std::optional<net::ClockEstimate>& clock);

  std::deque<Refresh> second_;
  std::optional<frames::FrameId> last_;
  std::string bound_ = "error bound not stated";  ///< of the newest frame
  std::size_t accounts_ = 0;                      ///< taken from the book
  display::Dashboard dashboard_;
};

}  // namespace macula::client_app
