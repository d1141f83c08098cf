#include "client/app/vitals.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace macula::client_app {
namespace {

constexpr Nanoseconds kSpan = std::chrono::seconds{1};

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), format, numbers...);
  return line.data();
}

display::StageColumn column_of(const frames::StageTimes& times) {
  display::StageColumn column{};
  std::transform(times.stages.begin(), times.stages.end(), column.begin(),
                 [](Nanoseconds stage) { return static_cast<float>(units::to_ms(stage)); });
  return column;
}

/// Of all eyes, in percent.
double percent(const std::vector<reprojection::WarpReport>& warps,
               std::uint64_t reprojection::WarpReport::*part) {
  std::uint64_t some = 0, all = 0;
  for (const auto& warp : warps) {
    some += warp.*part;
    all += warp.covered_px + warp.filled_px + warp.outside_px;
  }
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(some) / static_cast<double>(all);
}

/// The server's ladder: what it gives up, in the order in which it does.
std::string governor_line(const net::FrameQuality& quality) {
  std::string line = text("governor kernel %.1f of 10   scale %.2f   depth 1/%d", quality.kernel,
                          quality.scale, quality.depth_divisor);
  if (quality.color_budget_bytes > 0) {
    line += text("   %.0f kb a frame", 1e-3 * static_cast<double>(quality.color_budget_bytes));
  }
  return quality.stateless_color ? line + "   stateless" : line;
}

}  // namespace

void Vitals::note(const Showing& showing, const RunLog& log, const net::ClientEndpoint& endpoint) {
  const bool new_frame = last_ != showing.frame->id();
  last_ = showing.frame->id();
  second_.push_back({showing.shown, endpoint.counters().bytes, new_frame});
  while (showing.shown - second_.front().shown > kSpan) second_.pop_front();
  note_columns(log.book());
  write_lines(showing, endpoint.clock());
}

void Vitals::note_columns(const frames::StageBook& book) {
  const auto news = book.accounts_after(accounts_);
  accounts_ = book.accounted();
  for (const auto& account : news) dashboard_.columns.push_back(column_of(account.times));
  while (dashboard_.columns.size() > display::Dashboard::kColumns) dashboard_.columns.pop_front();
}

/// Of the newest frame: it is told once a frame.
std::string Vitals::bound_line(const Showing& showing) {
  if (showing.bound) {
    bound_ = text("error bound %.2f px   at worst %.1f px", showing.bound->p95_px,
                  std::min(showing.bound->most_px, 9999.0));
  }
  return bound_;
}

void Vitals::write_lines(const Showing& showing, const std::optional<net::ClockEstimate>& clock) {
  using Report = reprojection::WarpReport;
  const net::FrameBegin& begin = showing.frame->begin;
  const double span_s = std::max(units::to_s(second_.back().shown - second_.front().shown), 1e-3);
  const auto news = std::count_if(second_.begin() + 1, second_.end(),
                                  [](const Refresh& refresh) { return refresh.new_frame; });
  const double bits = 8.0 * static_cast<double>(second_.back().bytes - second_.front().bytes);
  dashboard_.lines = {
      text("pose age %5.0f ms   gaze age %5.0f ms",
           units::to_ms(showing.shown - begin.view_sampled),
           units::to_ms(showing.shown - begin.gaze_sampled)),
      text("server %5.1f /s   shown %5.1f /s   %.1f mbit/s", static_cast<double>(news) / span_s,
           static_cast<double>(second_.size() - 1) / span_s, 1e-6 * bits / span_s),
      text("filled %.2f per cent   outside %.2f per cent",
           percent(showing.warps, &Report::filled_px), percent(showing.warps, &Report::outside_px)),
      text("frame %.0f kb   %.0f k cells   %.0f k rays",
           1e-3 * static_cast<double>(showing.frame->bytes),
           1e-3 * static_cast<double>(showing.frame->end.cells),
           1e-3 * static_cast<double>(showing.frame->end.rays)),
      governor_line(begin.quality),
      bound_line(showing),
      text("hidden layer %.1f k cells   for %.1f cm",
           1e-3 * static_cast<double>(showing.frame->end.hidden_cells), 100.0 * begin.view_cell_m),
      clock ? text("clock known to %.2f ms", units::to_ms(clock->bound))
            : std::string("clock not known yet")};
}

}  // namespace macula::client_app
