#include "server/session/frame_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace macula::session {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 16384;
/// More than a window of every session: what is older was dropped with its session.
constexpr std::size_t kMostWaiting = 256;

struct Column {
  const char* name;
  double FrameRow::*value;
};
constexpr std::array kColumns{
    Column{"view_wait_ms", &FrameRow::view_wait_ms},
    Column{"render_ms", &FrameRow::render_ms},
    Column{"encode_ms", &FrameRow::encode_ms},
    Column{"credit_wait_ms", &FrameRow::credit_wait_ms},
    Column{"send_queue_ms", &FrameRow::send_queue_ms},
    Column{"encode_cpu_ms", &FrameRow::encode_cpu_ms},
    Column{"trace_ms", &FrameRow::trace_ms},
    Column{"shade_ms", &FrameRow::shade_ms},
    Column{"sample_ms", &FrameRow::sample_ms},
    Column{"reproject_ms", &FrameRow::reproject_ms},
    Column{"merge_ms", &FrameRow::merge_ms},
    Column{"post_ms", &FrameRow::post_ms},
    Column{"color_bytes", &FrameRow::color_bytes},
    Column{"depth_bytes", &FrameRow::depth_bytes},
    Column{"hidden_bytes", &FrameRow::hidden_bytes},
    Column{"cells", &FrameRow::cells},
    Column{"rays", &FrameRow::rays},
    Column{"scale", &FrameRow::scale},
};

FrameRow row_of(const FrameJob& job) {
  FrameRow row;
  row.view_wait_ms = units::to_ms(job.render_begin - job.start.view_received);
  row.render_ms = units::to_ms(job.render_end - job.render_begin);
  row.encode_ms = units::to_ms(job.encode_end - job.render_end);
  row.encode_cpu_ms = units::to_ms(job.encode_cpu);
  row.trace_ms = job.report.trace_ms;
  row.shade_ms = job.report.shade_ms;
  row.sample_ms = job.report.sample_ms;
  row.reproject_ms = job.report.reproject_ms;
  row.merge_ms = job.report.merge_ms;
  row.post_ms = job.report.post_ms;
  row.color_bytes = static_cast<double>(job.encoded.color_bytes);
  row.depth_bytes = static_cast<double>(job.encoded.depth_bytes);
  row.hidden_bytes = static_cast<double>(job.encoded.hidden_bytes);
  row.cells = static_cast<double>(job.cells);
  row.rays = static_cast<double>(job.report.primary_rays + job.report.shadow_rays);
  row.scale = job.scale;
  return row;
}

/// Of sorted values, the nearest rank; a microsecond and a byte are fine enough.
double quantile(const std::vector<double>& sorted, double share) {
  const auto last = static_cast<double>(sorted.size() - 1);
  return std::round(sorted[static_cast<std::size_t>(std::lround(share * last))] * 1e3) / 1e3;
}

Json quantiles(const std::deque<FrameRow>& rows, double FrameRow::*value) {
  if (rows.empty()) return nullptr;
  std::vector<double> sorted;
  sorted.reserve(rows.size());
  for (const FrameRow& row : rows) sorted.push_back(row.*value);
  std::sort(sorted.begin(), sorted.end());
  return {{"p50", quantile(sorted, 0.5)}, {"p95", quantile(sorted, 0.95)}, {"max", sorted.back()}};
}

tl::unexpected<Error> cannot_write(const std::string& path) {
  return base::runtime_error("cannot be written", path, "check the folder and the free space");
}

}  // namespace

Result<std::unique_ptr<FrameLog>> FrameLog::create(const std::string& folder) {
  std::unique_ptr<FrameLog> log(new FrameLog(folder));
  std::error_code ignored;  // the file says the same
  std::filesystem::create_directories(folder, ignored);
  const std::string path = folder + "/frames.csv";
  log->csv_.open(path);
  log->csv_.precision(9);
  log->csv_ << "epoch,frame";
  for (const Column& column : kColumns) log->csv_ << ',' << column.name;
  log->csv_ << ",lost\n" << std::flush;
  if (!log->csv_) return cannot_write(path);
  return log;
}

void FrameLog::add(const FrameJob& job) {
  if (waiting_.size() == kMostWaiting) waiting_.erase(waiting_.begin());
  const FrameKey& key = job.start.key;
  waiting_.insert_or_assign({key.epoch, key.frame}, Waiting{row_of(job), job.encode_end});
}

void FrameLog::on_sent(const net::FrameSent& sent) {
  auto found = waiting_.extract({sent.epoch, sent.frame});
  if (found.empty()) return;
  FrameRow& row = found.mapped().row;
  row.credit_wait_ms = units::to_ms(sent.begin - found.mapped().encoded);
  row.send_queue_ms = units::to_ms(sent.end - sent.begin);
  csv_ << sent.epoch << ',' << sent.frame;
  for (const Column& column : kColumns) csv_ << ',' << row.*column.value;
  csv_ << ',' << (sent.lost ? 1 : 0) << '\n';
  if (sent.lost) return;
  if (rows_.size() == kMostRows) rows_.pop_front();
  rows_.push_back(row);
}

std::string FrameLog::report(const Telemetry& t) const {
  Json frames = Json::object();
  for (const Column& column : kColumns) frames[column.name] = quantiles(rows_, column.value);
  const Json json = {{"frames_rendered", t.frames_rendered},
                     {"frames_encoded", t.frames_encoded},
                     {"frames_stopped", t.frames_stopped},
                     {"frames_failed", t.frames_failed},
                     {"frames_lost", t.sessions.frames_lost},
                     {"keys_wanted", t.sessions.keys_wanted},
                     {"views", t.sessions.views},
                     {"clients_welcomed", t.table.welcomed},
                     {"frames", frames}};
  return json.dump(2) + "\n";
}

Result<void> FrameLog::finish(const Telemetry& telemetry) {
  csv_.flush();
  if (!csv_) return cannot_write(folder_ + "/frames.csv");
  const std::string path = folder_ + "/report.json";
  std::ofstream file(path);
  file << report(telemetry);
  file.close();
  return file ? Result<void>{} : cannot_write(path);
}

}  // namespace macula::session
