#include "client/display/headless/report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/base/text.h"

namespace macula::display {
namespace {

using Json = nlohmann::ordered_json;

/// A microsecond is finer than any clock estimate.
double rounded(double value) {
  return std::round(value * 1e3) / 1e3;
}

Json quantiles(const frames::Series& series) {
  return {{"p50", rounded(series.quantile(0.5))},
          {"p95", rounded(series.quantile(0.95))},
          {"max", rounded(series.largest())}};
}

frames::Series over_accounts(const ClientReport& report, auto value) {
  frames::Series series;
  for (const auto& account : report.accounts) series.add(units::to_ms(value(account.times)));
  return series;
}

Json stages_json(const ClientReport& report) {
  Json stages = Json::object();
  for (std::size_t i = 0; i < frames::kStageCount; ++i) {
    const auto stage = static_cast<frames::Stage>(i);
    stages[frames::name(stage)] = quantiles(report.stage_ms(stage));
  }
  stages["total"] = quantiles(over_accounts(report, [](const auto& t) { return t.total; }));
  return stages;
}

Json accounting_json(const ClientReport& report) {
  const auto unattributed = over_accounts(report, [](const auto& t) { return t.unattributed; });
  const auto closure =
      over_accounts(report, [](const auto& t) { return std::chrono::abs(t.total - t.sum()); });
  return {{"frames_accounted", report.accounts.size() + report.accounts_left_out},
          {"frames_incomplete", report.accounts_incomplete},
          {"unattributed_max_ms", unattributed.largest()},
          {"sum_minus_total_max_ms", closure.largest()}};
}

Json reprojection_json(const ClientReport& report) {
  return {{"bound_p95_px", quantiles(report.bound_p95_px)},
          {"bound_most_px", quantiles(report.bound_most_px)},
          {"filled_share_mean", report.filled_share.mean()},
          {"filled_share_max", report.filled_share.largest()},
          {"outside_share_mean", report.outside_share.mean()},
          {"outside_share_max", report.outside_share.largest()}};
}

Json clock_json(const ClientReport& report) {
  if (!report.clock) return nullptr;
  return {{"bound_ms", units::to_ms(report.clock->bound)},
          {"min_rtt_ms", units::to_ms(report.clock->min_rtt)}};
}

Json network_json(const net::ClientCounters& counters) {
  return {{"frames", counters.frames},       {"frames_incomplete", counters.frames_incomplete},
          {"malformed", counters.malformed}, {"socket_remakes", counters.socket_remakes},
          {"bytes", counters.bytes},         {"views_sent", counters.views_sent}};
}

Json server_json(const ClientReport& report) {
  Json server = {{"cells_per_frame_p50", report.frame_cells.quantile(0.5)},
                 {"hidden_cells_per_frame_p50", report.hidden_cells.quantile(0.5)},
                 {"hidden_bytes_per_frame_p50", report.hidden_bytes.quantile(0.5)},
                 {"rays_per_frame_p50", report.frame_rays.quantile(0.5)}};
  if (report.welcome) {
    const net::Welcome& welcome = *report.welcome;
    server["scene"] = welcome.scene.name;
    server["triangles"] = welcome.scene.triangles;
    server["lights"] = welcome.scene.lights;
    server["kernel"] = welcome.kernel;
    server["color_codec"] = welcome.color_codec;
    server["frame_window"] = welcome.frame_window;
  }
  return server;
}

Json config_json(const ClientReport& report) {
  Json config = Json::object();
  for (const auto& [key, value] : report.config) config[key] = value;
  return config;
}

Result<void> write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    return base::runtime_error("cannot be written", path, "check the folder and the free space");
  }
  return {};
}

}  // namespace

const char* name(RunEnd end) {
  switch (end) {
    case RunEnd::FramesShown:
      return "frames shown";
    case RunEnd::PosesEnded:
      return "poses ended";
    case RunEnd::WindowClosed:
      return "window closed";
    case RunEnd::HeadsetClosed:
      return "headset closed";
    case RunEnd::HeadsetLost:
      return "headset lost";
    case RunEnd::Interrupted:
      return "interrupted";
    case RunEnd::ServerSilent:
      return "server silent";
  }
  return "?";
}

frames::Series ClientReport::stage_ms(frames::Stage stage) const {
  return over_accounts(*this, [stage](const auto& times) { return times[stage]; });
}

std::string to_json(const ClientReport& report) {
  const Json json = {
      {"ended", name(report.ended)},
      {"duration_s", rounded(report.duration_s)},
      {"shown_frames", report.shown_frames},
      {"distinct_server_frames", report.distinct_server_frames},
      {"frames_out_of_order", report.frames_out_of_order},
      {"refreshes_without_picture", report.refreshes_without_picture},
      {"refreshes_missed", report.refreshes_missed},
      {"frames_undecodable", report.frames_undecodable},
      {"gaze_changes_over_10_deg", report.gaze_changes_over_10_deg},
      {"pose_age_ms", quantiles(report.ages.pose_ms)},
      {"gaze_age_ms", quantiles(report.ages.gaze_ms)},
      {"stages_ms", stages_json(report)},
      {"stage_accounting", accounting_json(report)},
      {"reprojection", reprojection_json(report)},
      {"bytes_per_frame", quantiles(report.frame_bytes)},
      {"clock", clock_json(report)},
      {"network", network_json(report.network)},
      {"server", server_json(report)},
      {"pictures_written", report.pictures_written},
      {"pictures_skipped", report.pictures_skipped},
      {"config", config_json(report)},
  };
  // Text from the peer may hold anything; what is not UTF-8 is replaced rather than refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string frames_csv(const ClientReport& report) {
  std::ostringstream text;
  text << "epoch,frame";
  for (std::size_t i = 0; i < frames::kStageCount; ++i) {
    text << ',' << frames::name(static_cast<frames::Stage>(i)) << "_ms";
  }
  text << ",unattributed_ms,total_ms\n";
  for (const auto& [id, times] : report.accounts) {
    text << id.epoch << ',' << id.frame;
    for (const Nanoseconds stage : times.stages) text << ',' << units::to_ms(stage);
    text << ',' << units::to_ms(times.unattributed) << ',' << units::to_ms(times.total) << '\n';
  }
  return std::move(text).str();
}

Result<void> write_reports(const std::string& folder, const ClientReport& report) {
  if (auto done = write_text(folder + "/report.json", to_json(report)); !done) return done;
  return write_text(folder + "/frames.csv", frames_csv(report));
}

std::string summary(const ClientReport& report) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  const auto row = [&text](const char* label, const frames::Series& ms) {
    text << "  " << std::left << std::setw(14) << label << std::right << std::setw(8)
         << ms.quantile(0.5) << std::setw(8) << ms.quantile(0.95) << "\n";
  };
  text << report.shown_frames << " frames shown from " << report.distinct_server_frames
       << " server frames in " << report.duration_s << " s (" << name(report.ended) << "); "
       << report.gaze_changes_over_10_deg << " gaze changes over 10 degrees\n"
       << "  ms                 p50     p95\n";
  row("pose age", report.ages.pose_ms);
  row("gaze age", report.ages.gaze_ms);
  for (std::size_t i = 0; i < frames::kStageCount; ++i) {
    const auto stage = static_cast<frames::Stage>(i);
    row(frames::name(stage), report.stage_ms(stage));
  }
  return std::move(text).str();
}

}  // namespace macula::display
